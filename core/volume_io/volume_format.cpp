// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/volume_format.h"

#include "core/base/text_parse.h"

namespace limber {

// Each function returns one entry of the table of volume formats, and is defined in the source file of that format.
VolumeFormat nrrd_format();
VolumeFormat metaimage_format();
VolumeFormat nifti_format();
VolumeFormat virtual_family_format();
VolumeFormat vti_format();

namespace {

// DICOM's table entry has no functions: dicom.h reads DICOM, and nothing writes it.
VolumeFormat dicom_format() { return {.name = "DICOM", .endings = {".dcm"}}; }

struct Match {
  const VolumeFormat* format = nullptr;
  const VolumeFormat::Written* written = nullptr;
};

// Returns the format and the writer whose file name ending matches `path`. The longest matching ending wins. Returns
// nulls when none matches.
Match match_of(const Path& path) {
  const std::string name = lower_case(path.filename().string());
  Match found;
  for (const VolumeFormat& format : volume_formats())
    for (const VolumeFormat::Written& written : format.written) {
      const bool fits = name.ends_with(written.ending) && name.size() > written.ending.size();
      if (fits && (!found.written || written.ending.size() > found.written->ending.size())) found = {&format, &written};
    }
  return found;
}

}  // namespace

std::span<const VolumeFormat> volume_formats() {
  static const std::vector<VolumeFormat> kVolumeFormats = {
      nrrd_format(), nifti_format(), metaimage_format(), vti_format(), virtual_family_format(), dicom_format(),
  };
  return kVolumeFormats;
}

const VolumeFormat::Written* how_written(const Path& path) { return match_of(path).written; }

std::string format_written_as(const Path& path) {
  const VolumeFormat* format = match_of(path).format;
  return format ? format->name : "";
}

std::string writable_endings() {
  std::string all;
  for (const VolumeFormat& format : volume_formats())
    for (const VolumeFormat::Written& written : format.written) all += (all.empty() ? "" : ", ") + written.ending;
  return all;
}

std::string readable_formats() {
  std::string all;
  for (const VolumeFormat& format : volume_formats()) all += (all.empty() ? "" : ", ") + format.name;
  return all;
}

}  // namespace limber
