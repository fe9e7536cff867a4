// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/nifti.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include <glm/gtc/quaternion.hpp>

#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/volume_io/volume_format.h"

namespace limber {

namespace {
// The byte offsets and the width of the header's fields in one of the two NIfTI versions.
struct Layout {
  int bytes, dim, pixdim, datatype, bitpix, vox_offset, slope, intercept, intent, qform_code, sform_code, quaternion,
      q_offset, srow, units, magic;
  bool wide;  // true in version 2: fields are int64 and double instead of int16 and float
};
constexpr Layout kVersion1 = {348, 40, 76, 70, 72, 108, 112, 116, 68, 252, 254, 256, 268, 280, 123, 344, false};
constexpr Layout kVersion2 = {540, 16, 104, 12, 14, 168, 176, 184, 504, 344, 348, 352, 376, 400, 500, 4, true};

constexpr std::array<std::pair<int, VoxelType>, 10> kDatatypes = {{{2, VoxelType::UInt8},
                                                                   {4, VoxelType::Int16},
                                                                   {8, VoxelType::Int32},
                                                                   {16, VoxelType::Float32},
                                                                   {64, VoxelType::Float64},
                                                                   {256, VoxelType::Int8},
                                                                   {512, VoxelType::UInt16},
                                                                   {768, VoxelType::UInt32},
                                                                   {1024, VoxelType::Int64},
                                                                   {1280, VoxelType::UInt64}}};

// Reads numbers at byte offsets of a header. The header must be at least as long as its version requires.
class Fields {
 public:
  Fields(std::string_view bytes, bool swap, const Layout& layout) : bytes_(bytes), swap_(swap), layout_(layout) {}

  template <class T>
  T get(int place) const {
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data() + place, sizeof(T));
    if (swap_) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
  }
  std::int64_t whole(int place, int i = 0) const {
    return layout_.wide ? get<std::int64_t>(place + 8 * i) : get<std::int16_t>(place + 2 * i);
  }
  // Reads a code, that is, a number that stands for a choice. Codes are int16 in version 1 and int32 in version 2. The
  // datatype must not be read by this function, since it is int16 in both versions.
  int code(int place) const { return layout_.wide ? get<std::int32_t>(place) : get<std::int16_t>(place); }
  double real(int place, int i = 0) const {
    return layout_.wide ? get<double>(place + 8 * i) : get<float>(place + 4 * i);
  }

 private:
  std::string_view bytes_;
  bool swap_;
  const Layout& layout_;
};

struct Version {
  const Layout* layout;
  bool swap, is_pair;
};

std::optional<Version> version_of(std::string_view bytes) {
  if (bytes.size() < 348) return std::nullopt;
  std::int32_t size;
  std::memcpy(&size, bytes.data(), 4);
  for (bool swap : {false, true}) {
    const auto said = swap ? static_cast<std::int32_t>(__builtin_bswap32(static_cast<std::uint32_t>(size))) : size;
    const auto magic = [&](const Layout& layout, std::string_view text) {
      return bytes.substr(static_cast<std::size_t>(layout.magic), text.size()) == text;
    };
    using namespace std::string_view_literals;
    if (said == 348 && (magic(kVersion1, "n+1\0"sv) || magic(kVersion1, "ni1\0"sv)))
      return Version{&kVersion1, swap, bytes[345] == 'i'};
    if (said == 540 && bytes.size() >= 540 && (magic(kVersion2, "n+2\0"sv) || magic(kVersion2, "ni2\0"sv)))
      return Version{&kVersion2, swap, bytes[5] == 'i'};
  }
  return std::nullopt;
}

bool usable(const glm::dmat3& columns) {
  const RawGrid raw = grid_from_columns({}, columns, glm::dvec3(0));
  for (int i = 0; i < 3; ++i)
    if (!std::isfinite(raw.spacing[i]) || raw.spacing[i] <= 0) return false;
  return std::abs(glm::determinant(raw.direction)) > 1e-3;
}

// Returns the rotation of the qform. The header stores the components b, c, d of a quaternion of length 1, from which
// the first component follows [NIfTI-1, quaternion representation].
glm::dmat3 rotation_of(double b, double c, double d) {
  const double rest = 1 - (b * b + c * c + d * d);
  glm::dquat q(rest > 0 ? std::sqrt(rest) : 0, b, c, d);
  if (rest <= 0) q = glm::normalize(q);
  return glm::mat3_cast(q);
}

class NiftiReader {
 public:
  NiftiReader(std::string_view bytes, const Version& version, std::optional<std::int64_t> file_bytes,
              const std::string& where)
      : at_(*version.layout),
        fields_(bytes, version.swap, *version.layout),
        file_bytes_(file_bytes),
        where_(where) {
    header_.is_pair = version.is_pair;
    header_.volume.format = at_.wide ? "NIfTI-2" : "NIfTI-1";
    header_.volume.big_endian = version.swap != (std::endian::native == std::endian::big);
  }

  NiftiHeader read() {
    read_type();
    read_sizes();
    read_place();
    read_scale();
    read_offset();
    return std::move(header_);
  }

 private:
  void read_type() {
    const int code = fields_.get<std::int16_t>(at_.datatype);
    if (code == 128 || code == 2304) throw Error("the voxels are colours (RGB)", where_, "export one label per voxel");
    if (code == 32 || code == 1792 || code == 2048)
      throw Error("the voxels are complex numbers", where_, "export one label per voxel");
    const auto found =
        std::find_if(kDatatypes.begin(), kDatatypes.end(), [&](const auto& pair) { return pair.first == code; });
    if (found == kDatatypes.end())
      throw Error("unknown NIfTI datatype " + std::to_string(code), where_,
                  "save as uint8, uint16 or another scalar type");
    header_.volume.voxel_type = found->second;
    const int bits = fields_.get<std::int16_t>(at_.bitpix);
    if (bits != 8 * size_of(found->second))
      warn("bitpix is " + std::to_string(bits),
           "the datatype says " + std::to_string(8 * size_of(found->second)) + ", which is used");
  }

  void read_sizes() {
    const std::int64_t axes = fields_.whole(at_.dim);
    if (axes < 1 || axes > 7)
      throw Error("the file has " + std::to_string(axes) + " axes (dim[0])", where_, "save one 3-D volume");
    for (int i = 1; i <= axes; ++i) sizes_.push_back(fields_.whole(at_.dim, i));
  }

  // Returns the voxel size (field pixdim), mm. Throws Error for an invalid size, except along an axis of only one
  // voxel.
  glm::dvec3 voxel_size() const {
    glm::dvec3 size(1);
    for (int i = 0; i < 3; ++i) {
      const double said = fields_.real(at_.pixdim, i + 1);
      const bool thin = i >= std::ssize(sizes_) || sizes_[static_cast<std::size_t>(i)] == 1;
      if (thin && !(std::isfinite(said) && said > 0)) continue;
      if (!std::isfinite(said) || said <= 0)
        throw Error("the voxel size along axis " + std::to_string(i + 1) + " (pixdim) is " + text_of(said), where_,
                    "spacing must be positive and finite; correct the header");
      size[i] = said;
    }
    return size;
  }

  void read_place() {
    const glm::dvec3 size = voxel_size();
    glm::dmat3 columns(1);
    glm::dvec3 origin(0);
    for (int i = 0; i < 3; ++i) columns[i] *= size[i];

    const bool has_sform = fields_.code(at_.sform_code) > 0, has_qform = fields_.code(at_.qform_code) > 0;
    glm::dmat3 sform(1);
    glm::dvec3 sform_origin(0);
    for (int row = 0; row < 3; ++row) {
      for (int i = 0; i < 3; ++i) sform[i][row] = fields_.real(at_.srow, 4 * row + i);
      sform_origin[row] = fields_.real(at_.srow, 4 * row + 3);
    }
    if (has_sform && usable(sform)) {
      columns = sform;
      origin = sform_origin;
    } else if (has_qform) {
      if (has_sform) warn("the sform is singular", "the qform is used");
      columns = rotation_of(fields_.real(at_.quaternion, 0), fields_.real(at_.quaternion, 1),
                            fields_.real(at_.quaternion, 2));
      const bool flipped = fields_.real(at_.pixdim, 0) < 0;
      for (int i = 0; i < 3; ++i) columns[i] *= size[i] * (i == 2 && flipped ? -1 : 1);
      for (int i = 0; i < 3; ++i) origin[i] = fields_.real(at_.q_offset, i);
      if (!usable(columns)) throw Error("the qform is not a rotation", where_, "correct the header");
    } else if (has_sform) {
      throw Error("the sform is singular and there is no qform", where_, "correct the header");
    }

    const double unit = millimetres();
    const glm::dvec3 to_lps(-unit, -unit, unit);
    for (int i = 0; i < 3; ++i) columns[i] *= to_lps;
    const RawGrid raw = grid_from_columns(sizes_, columns, origin * to_lps);
    header_.volume.grid = checked_grid(raw, where_, header_.volume.warnings);
  }

  double millimetres() const {
    const int code = (at_.wide ? fields_.get<std::int32_t>(at_.units) : fields_.get<std::uint8_t>(at_.units)) & 7;
    return code == 1 ? 1000 : code == 3 ? 1e-3 : 1;
  }

  void read_scale() {
    const double slope = fields_.real(at_.slope), intercept = fields_.real(at_.intercept);
    if (slope == 0 || std::isnan(slope)) return;  // slope 0 or NaN: the file's values are not scaled
    header_.volume.slope = slope;
    header_.volume.intercept = std::isnan(intercept) ? 0 : intercept;
    check_scale(header_.volume.slope, header_.volume.intercept, where_);
  }

  void read_offset() {
    VolumeHeader& volume = header_.volume;
    const double said =
        at_.wide ? static_cast<double>(fields_.get<std::int64_t>(at_.vox_offset)) : fields_.real(at_.vox_offset);
    const bool finite = std::isfinite(said) && said >= 0 && said < 1e15 && said == std::floor(said);
    if (header_.is_pair) {
      if (!finite) throw Error("vox_offset is " + text_of(said), where_, "correct the header");
      volume.byte_skip = static_cast<std::int64_t>(said);
      return;
    }
    const std::int64_t after_header = at_.bytes + 4, bytes = volume.grid.voxel_count() * size_of(volume.voxel_type);
    std::int64_t offset = finite ? static_cast<std::int64_t>(said) : -1;
    const bool fits = offset >= at_.bytes && (!file_bytes_ || offset + bytes <= *file_bytes_);
    const bool whole_after_header = !file_bytes_ || *file_bytes_ == after_header + bytes;
    if (!fits && (whole_after_header || offset < at_.bytes)) {
      warn("vox_offset is " + text_of(said),
           "the data are read after the header, from byte " + std::to_string(after_header));
      offset = after_header;
    }
    volume.byte_skip = offset;
  }

  void warn(const std::string& what, const std::string& then) {
    header_.volume.warnings.push_back(what + ": " + where_ + ": " + then);
  }

  const Layout& at_;
  Fields fields_;
  std::optional<std::int64_t> file_bytes_;
  std::string where_;
  std::vector<std::int64_t> sizes_;
  NiftiHeader header_;
};

class HeaderBytes {
 public:
  explicit HeaderBytes(const Layout& layout) : at_(layout), bytes_(static_cast<std::size_t>(layout.bytes) + 4, '\0') {}

  template <class T>
  void put(int place, T value) {
    std::memcpy(bytes_.data() + place, &value, sizeof(T));
  }
  void whole(int place, int i, std::int64_t value) {
    at_.wide ? put(place + 8 * i, value) : put(place + 2 * i, static_cast<std::int16_t>(value));
  }
  void code(int place, int value) {
    at_.wide ? put(place, std::int32_t{value}) : put(place, static_cast<std::int16_t>(value));
  }
  void real(int place, int i, double value) {
    at_.wide ? put(place + 8 * i, value) : put(place + 4 * i, static_cast<float>(value));
  }
  std::string take() { return std::move(bytes_); }

 private:
  const Layout& at_;
  std::string bytes_;
};

// Writes a qform equal to the sform, for programs that read only the qform. Writes none when the axes are not at right
// angles, because a qform can store only rotations and mirrors.
void put_qform(HeaderBytes& bytes, const Layout& at, glm::dmat3 ras_direction, const glm::dvec3& origin) {
  const glm::dmat3 product = glm::transpose(ras_direction) * ras_direction;
  for (int i = 0; i < 3; ++i)
    if (glm::length(product[i] - glm::dmat3(1)[i]) > 1e-5) return;
  const bool mirrored = glm::determinant(ras_direction) < 0;
  if (mirrored) ras_direction[2] = -ras_direction[2];
  glm::dquat q = glm::normalize(glm::quat_cast(ras_direction));
  if (q.w < 0) q = -q;
  bytes.code(at.qform_code, 1);
  bytes.real(at.pixdim, 0, mirrored ? -1 : 1);
  bytes.real(at.quaternion, 0, q.x);
  bytes.real(at.quaternion, 1, q.y);
  bytes.real(at.quaternion, 2, q.z);
  for (int i = 0; i < 3; ++i) bytes.real(at.q_offset, i, origin[i]);
}
}  // namespace

bool looks_like_nifti_header(std::string_view bytes) { return version_of(bytes).has_value(); }

NiftiHeader parse_nifti_header(std::string_view bytes, std::optional<std::int64_t> file_bytes,
                               const std::string& where) {
  const auto version = version_of(bytes);
  if (!version)
    throw Error("this is not a NIfTI file", where,
                "its header is cut off, damaged, or of the older Analyze format; save it as .nii");
  return NiftiReader(bytes, *version, file_bytes, where).read();
}

std::string make_nifti_header(const Grid& grid, VoxelType type, int channels, int version, bool is_pair) {
  const Layout& at = version == 2 ? kVersion2 : kVersion1;
  HeaderBytes bytes(at);
  bytes.put(0, std::int32_t{at.bytes});
  constexpr int kAxes = 5;
  for (int i = 0; i <= 7; ++i) bytes.whole(at.dim, i, 1);
  bytes.whole(at.dim, 0, channels > 1 ? kAxes : 3);
  for (int i = 0; i < 3; ++i) bytes.whole(at.dim, i + 1, grid.size[i]);
  if (channels > 1) bytes.whole(at.dim, kAxes, channels);
  constexpr int kIntentVector = 1007;
  if (channels > 1) bytes.code(at.intent, kIntentVector);
  bytes.real(at.pixdim, 0, 1);
  for (int i = 0; i < 3; ++i) bytes.real(at.pixdim, i + 1, grid.spacing[i]);
  for (int i = 4; i <= 7; ++i) bytes.real(at.pixdim, i, 1);
  for (const auto& [code, known] : kDatatypes)
    if (known == type) bytes.put(at.datatype, static_cast<std::int16_t>(code));
  bytes.put(at.bitpix, static_cast<std::int16_t>(8 * size_of(type)));
  bytes.real(at.slope, 0, 1);
  const std::int64_t offset = is_pair ? 0 : at.bytes + 4;
  at.wide ? bytes.put(at.vox_offset, offset) : bytes.put(at.vox_offset, static_cast<float>(offset));
  constexpr int kMillimetre = 2;
  at.wide ? bytes.put(at.units, std::int32_t{kMillimetre})
          : bytes.put(at.units, static_cast<std::uint8_t>(kMillimetre));

  const glm::dvec3 to_ras(-1, -1, 1);
  const AffineTransform world = world_from_voxel(grid);
  bytes.code(at.sform_code, 1);
  for (int row = 0; row < 3; ++row) {
    for (int i = 0; i < 3; ++i) bytes.real(at.srow, 4 * row + i, world.linear[i][row] * to_ras[row]);
    bytes.real(at.srow, 4 * row + 3, grid.origin[row] * to_ras[row]);
  }
  glm::dmat3 ras = grid.direction;
  for (int i = 0; i < 3; ++i) ras[i] *= to_ras;
  put_qform(bytes, at, ras, grid.origin * to_ras);

  const char digit = version == 2 ? '2' : '1';
  const std::array<char, 8> magic = {'n', is_pair ? 'i' : '+', digit, '\0', '\r', '\n', '\032', '\n'};
  std::string text = bytes.take();
  std::memcpy(text.data() + at.magic, magic.data(), version == 2 ? 8 : 4);
  return text;
}

namespace {

bool is_gzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

// Returns the first `most` bytes of a gzip stream's content, or fewer when the stream is damaged or shorter.
std::string inflated_start(std::string_view packed, std::size_t most) {
  std::string plain(most, '\0');
  Inflater stream;
  std::size_t done = 0;
  for (bool moves = true; moves && done < most && !stream.ended();) {
    const Inflater::Step step = stream.inflate(packed, plain.data() + done, most - done);
    packed.remove_prefix(step.taken);
    done += step.made;
    moves = !step.damaged && step.taken + step.made > 0;
  }
  plain.resize(done);
  return plain;
}

VolumeHeader read_nifti(VolumeFiles& files, const PlainFile& file, const std::string& bytes) {
  const Path& path = files.location().headers.front();
  const bool packed = is_gzip(bytes);
  const std::string start = packed ? inflated_start(bytes, kNiftiHeaderBytes) : bytes;
  NiftiHeader nifti = parse_nifti_header(start, packed ? std::nullopt : std::optional(file.size()), path.string());
  VolumeHeader& header = nifti.volume;
  bool data_packed = packed;
  if (nifti.is_pair) {
    Path image = path.filename();
    if (lower_case(image.string()).ends_with(".gz")) image.replace_extension();
    image.replace_extension(".img");
    if (!files.has_data(image.string()) && files.has_data(image.string() + ".gz")) image += ".gz";
    header.data_names = {image.string()};
    data_packed = lower_case(image.string()).ends_with(".gz");
  }
  if (data_packed) {
    header.encoding = Encoding::Deflate;
    std::swap(header.byte_skip, header.decoded_skip);
  }
  return std::move(header);
}

// Returns the NIfTI version to write. It is 2 when an axis has more than 32767 voxels, because version 1 stores sizes
// in 16 bits.
int nifti_version(const Voxels& voxels) {
  const glm::ivec3 size = voxels.grid.size;
  return std::max({size.x, size.y, size.z}) > 32767 ? 2 : voxels.nifti_version;
}

std::string nifti_header(const Voxels& voxels, bool is_pair) {
  const int version = nifti_version(voxels);
  std::string bytes = make_nifti_header(voxels.grid, voxels.type, voxels.channels, version, is_pair);
  constexpr std::size_t kDescription[] = {148, 240};  // byte offset of the field `descrip` in versions 1 and 2
  bytes.replace(kDescription[version - 1], voxels.description.size(), voxels.description);
  return bytes;
}

void write_nifti(const Voxels& voxels, const Path& path) {
  const bool compress = lower_case(path.extension().string()) == ".gz";
  write_atomically(path, [&](const Path& temporary) {
    OutputFile out(temporary);
    if (compress) out.begin_deflate(Deflater::Wrap::Gzip);
    write_text(out, nifti_header(voxels, false));
    write_voxels(out, voxels);
    if (compress) out.end_deflate();
    out.close();
  });
}

void write_nifti_pair(const Voxels& voxels, const Path& path) {
  Voxels plain = voxels;
  plain.compress = false;
  write_detached(plain, path, ".img", Deflater::Wrap::Gzip,
                 [&](const std::string&, std::int64_t) { return nifti_header(plain, true); });
}

}  // namespace

VolumeFormat nifti_format() {
  return {.name = "NIfTI",
          .endings = {".nii", ".nii.gz", ".hdr", ".hdr.gz", ".img", ".img.gz"},
          .fits =
              [](std::string_view name, std::string_view bytes) {
                return name.ends_with(".nii") || name.ends_with(".nii.gz") || name.ends_with(".hdr") ||
                       name.ends_with(".hdr.gz") || looks_like_nifti_header(bytes);
              },
          .read_header = read_nifti,
          .written = {{".nii.gz", write_nifti}, {".nii", write_nifti}, {".hdr", write_nifti_pair, {".img"}, false}}};
}

}  // namespace limber
