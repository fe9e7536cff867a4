// SPDX-License-Identifier: AGPL-3.0-or-later
// The ray through the picture at `ndc`; render/passes/view_rays.h tells what these hold.
uniform vec3 u_base, u_base_x, u_base_y, u_toward, u_toward_x, u_toward_y;
