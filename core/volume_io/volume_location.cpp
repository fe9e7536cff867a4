// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/volume_location.h"

#include <algorithm>

#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/volume_io/dicom.h"

namespace limber {

namespace fs = std::filesystem;

PlainFile::PlainFile(const Path& path) {
  std::error_code error;
  file_ = OpenFile(path, Opening::Read, error);
  if (error) throw Error("the file cannot be opened", path.string(), error.message());
  const auto status = file_.status();
  if (!status || !status->is_regular) throw Error("this is not a plain file", path.string(), "name a file on disk");
  size_ = status->size;
}

std::string first_bytes(const PlainFile& file, std::int64_t most) {
  std::string bytes(static_cast<std::size_t>(std::min(file.size(), most)), '\0');
  bytes.resize(file.read_at(0, bytes.data(), bytes.size()));
  return bytes;
}

namespace {

bool ends(const Path& path, std::string_view end) { return lower_case(path.filename().string()).ends_with(end); }

// Returns the file that holds the volume's header: NAME.hdr for NAME.img and NAME.img.gz, NAME.txt for NAME.raw, else
// the given file.
Path header_path(const Path& given) {
  Path path = given;
  if (ends(path, ".raw")) return path.replace_extension(".txt");
  if (!ends(path, ".img") && !ends(path, ".img.gz")) return path;
  if (ends(path, ".gz")) path.replace_extension();
  return path.replace_extension(".hdr");
}

// Returns the path of the data file `name`. Throws Error unless the file lies in the header's folder after symbolic
// links are resolved.
Path checked_data_path(const Path& header_path, const std::string& name) {
  const Path relative(name);
  const auto outside = [&] {
    return Error("the data file " + in_quotes(name) + " lies outside the header's folder", header_path.string(),
                 "put it beside the header and name it without a path");
  };
  if (relative.is_absolute() || name.find('\0') != std::string::npos) throw outside();
  for (const auto& part : relative)
    if (part == "..") throw outside();
  const Path folder = header_path.has_parent_path() ? header_path.parent_path() : Path(".");
  const Path path = folder / relative;
  std::error_code error;
  const Path real = fs::canonical(path, error);
  if (error)
    throw Error("the data file " + in_quotes(name) + " is missing", header_path.string(), "put it beside the header");
  const Path real_folder = fs::canonical(folder, error);
  const auto [folder_end, ignored] = std::mismatch(real_folder.begin(), real_folder.end(), real.begin(), real.end());
  if (error || folder_end != real_folder.end()) throw outside();
  return path;
}

}  // namespace

VolumeLocation locate_volume(const Path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return {path, true, dicom_files(path)};
  if (is_dicom_file(path)) return {path, true, {path}};
  const Path header = header_path(path);
  if (fs::exists(header, error)) return {path, false, {header}};
  if (header == path) throw Error("there is no such file", path.string(), "check the name");
  throw Error("the header " + in_quotes(header.filename().string()) + " is missing", path.string(),
              "put it beside the data");
}

PlainFile LocalFiles::open_header(std::size_t index) { return PlainFile(location().headers.at(index)); }

void LocalFiles::check_data(const std::vector<std::string>& names) {
  for (const std::string& name : names) checked_data_path(location().headers.front(), name);
}

PlainFile LocalFiles::open_data(const std::string& name) {
  return PlainFile(checked_data_path(location().headers.front(), name));
}

bool LocalFiles::has_data(const std::string& name) {
  try {
    checked_data_path(location().headers.front(), name);
    return true;
  } catch (const Error&) {
    return false;
  }
}

}  // namespace limber
