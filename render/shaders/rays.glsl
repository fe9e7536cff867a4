// SPDX-License-Identifier: AGPL-3.0-or-later
// The uniforms that describe the rays of a picture; render/passes/view_rays.h explains them.
uniform vec3 u_base, u_base_x, u_base_y, u_toward, u_toward_x, u_toward_y;
