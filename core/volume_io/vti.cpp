// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and writes VTK's XML image data (.vti) [VTK File Formats, VTK 9]: one <Piece> whose points or cells are the
// voxels, with one component. The voxel data are inside the XML as numbers or base64, or appended after it as raw bytes
// or base64. Compressed data are zlib blocks after a table of their sizes. Coordinates are used unchanged as LPS in mm,
// because VTK defines no convention.
#include <algorithm>
#include <array>
#include <cstring>
#include <map>

#include <expat.h>

#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/volume_io/volume_format.h"

namespace limber {

namespace {

constexpr std::array<std::string_view, 10> kTypes = {"Int8",   "UInt8", "Int16",  "UInt16",  "Int32",
                                                     "UInt32", "Int64", "UInt64", "Float32", "Float64"};
constexpr std::string_view kZlib = "vtkZLibDataCompressor";

using Attributes = std::map<std::string, std::string, std::less<>>;

// The content of the file's XML header as far as it has been read.
struct VtiHeader {
  Attributes file, image, piece, array;  // attributes of VTKFile, ImageData, Piece and the chosen DataArray
  bool in_cells = false;
  std::string appended;       // encoding of appended data: "raw", "base64"; empty: no appended data
  std::int64_t data_at = -1;  // offset of the data in the file, bytes
};

// Parses the file's XML up to the start of the voxel data, and chooses the array that holds them.
class VtiText {
 public:
  VtiText(const PlainFile& file, const std::string& where) : file_(file), where_(where) {}

  VtiHeader read() {
    const std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)> parser(
        XML_ParserCreate(nullptr), XML_ParserFree);
    if (!parser) throw std::bad_alloc();
    parser_ = parser.get();
    XML_SetHashSalt(parser_, 0x51ed270b);  // a fixed salt, because a sandbox cannot open /dev/urandom for a random one
    XML_SetUserData(parser_, this);
    XML_SetElementHandler(
        parser_, [](void* self, const char* name, const char** a) { static_cast<VtiText*>(self)->open(name, a); },
        [](void*, const char*) {});
    constexpr std::int64_t kPart = 1 << 16;
    std::string part(kPart, '\0');
    while (!stopped_ && place_ < std::min(file_.size(), kLargestHeader)) {
      part.resize(kPart);
      part.resize(file_.read_at(place_, part.data(), part.size()));
      const bool last = place_ + std::ssize(part) >= file_.size();
      const auto status = XML_Parse(parser_, part.data(), static_cast<int>(part.size()), last);
      if (failure_) throw *failure_;
      if (status != XML_STATUS_OK && !stopped_)
        throw Error(std::string("this is not valid XML (") + XML_ErrorString(XML_GetErrorCode(parser_)) + ")",
                    where_ + ", line " + std::to_string(XML_GetCurrentLineNumber(parser_)), "export the volume again");
      place_ += std::ssize(part);
    }
    if (header_.array.empty())
      throw Error("the image holds no array of one value per voxel", where_, "export the labels of the image");
    if (header_.data_at < 0)
      throw Error("the data of " + in_quotes(header_.array["Name"]) + " are missing", where_,
                  "export the volume again");
    return std::move(header_);
  }

 private:
  static Attributes all(const char** attributes) {
    Attributes all;
    for (; *attributes; attributes += 2) all[attributes[0]] = attributes[1];
    return all;
  }

  void open(const std::string& name, const char** attributes) {
    if (stopped_) return;
    if (name == "VTKFile") {
      header_.file = all(attributes);
      if (header_.file["type"] != "ImageData")
        return fail("the VTK file holds " + in_quotes(header_.file["type"]), "only ImageData is read");
    }
    if (name == "ImageData") header_.image = all(attributes);
    if (name == "Piece") {
      if (!header_.piece.empty()) return fail("the image is in several pieces", "export the image as one piece");
      header_.piece = all(attributes);
    }
    if (name == "PointData" || name == "CellData") {
      in_data_ = true;
      in_cells_ = name == "CellData";
      const Attributes own = all(attributes);
      wanted_ = own.contains("Scalars") ? own.at("Scalars") : "";
    }
    if (name == "DataArray" && in_data_ && !header_.piece.empty()) consider(all(attributes));
    if (name == "AppendedData" && header_.array["format"] == "appended") begin_appended(all(attributes));
  }

  // Chooses an array of one component: the one with the name in the attribute Scalars, or without Scalars the first.
  void consider(Attributes array) {
    const bool one = !array.contains("NumberOfComponents") || array["NumberOfComponents"] == "1";
    const bool named = !wanted_.empty() && array["Name"] == wanted_;
    if (!one || (!header_.array.empty() && !named) || (!wanted_.empty() && !named)) return;
    header_.array = std::move(array);
    header_.in_cells = in_cells_;
    if (header_.array["format"] == "appended") return;
    header_.data_at = behind_tag();
    stop();
  }

  void begin_appended(const Attributes& attributes) {
    header_.appended = attributes.contains("encoding") ? attributes.at("encoding") : "raw";
    const auto offset = number_of<std::int64_t>(header_.array["offset"]);
    char mark = 0;
    std::int64_t at = behind_tag();
    while (at < file_.size() && file_.read_at(at, &mark, 1) == 1 && is_blank(mark)) ++at;
    if (mark != '_' || !offset || *offset < 0 || *offset > file_.size())
      return fail("the appended data cannot be found", "export the volume again");
    header_.data_at = at + 1 + *offset;
    stop();
  }

  // Returns the file offset of the first byte behind the XML tag that the parser is reporting.
  std::int64_t behind_tag() const { return XML_GetCurrentByteIndex(parser_) + XML_GetCurrentByteCount(parser_); }

  void stop() {
    stopped_ = true;
    XML_StopParser(parser_, XML_FALSE);
  }
  // Stops the parser and stores an Error, which is thrown after the C code of the parser has returned.
  void fail(const std::string& what, const std::string& remedy) {
    failure_.emplace(what, where_, remedy);
    stop();
  }

  const PlainFile& file_;
  const std::string where_;
  XML_Parser parser_ = nullptr;
  std::int64_t place_ = 0;
  VtiHeader header_;
  std::string wanted_;
  std::optional<Error> failure_;
  bool in_data_ = false, in_cells_ = false, stopped_ = false;
};

std::array<int, 6> extent_of(const Attributes& attributes, const char* name, const std::string& where) {
  const auto found = attributes.find(name);
  const auto numbers = found == attributes.end() ? std::nullopt : numbers_of<int>(found->second);
  if (!numbers || numbers->size() != 6)
    throw Error(std::string(name) + " is missing or wrong", where, "six whole numbers are needed; correct the header");
  std::array<int, 6> extent;
  std::copy(numbers->begin(), numbers->end(), extent.begin());
  return extent;
}

std::vector<double> numbers_in(const Attributes& attributes, const char* name, std::vector<double> otherwise,
                               const std::string& where) {
  const auto found = attributes.find(name);
  if (found == attributes.end()) return otherwise;
  const auto numbers = numbers_of<double>(found->second);
  if (!numbers || numbers->size() != otherwise.size())
    throw Error(std::string(name) + " is " + in_quotes(found->second), where,
                std::to_string(otherwise.size()) + " numbers are needed; correct the header");
  return *numbers;
}

RawGrid grid_of(const VtiHeader& vti, const std::string& where) {
  const std::array<int, 6> whole = extent_of(vti.image, "WholeExtent", where);
  if (extent_of(vti.piece, "Extent", where) != whole)
    throw Error("the image is in several pieces", where, "export the image as one piece");
  const auto origin = numbers_in(vti.image, "Origin", {0, 0, 0}, where);
  const auto spacing = numbers_in(vti.image, "Spacing", {1, 1, 1}, where);
  const auto direction = numbers_in(vti.image, "Direction", {1, 0, 0, 0, 1, 0, 0, 0, 1}, where);
  RawGrid raw;
  glm::dvec3 first(0);
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(axis);
    raw.sizes.push_back(std::int64_t{whole[2 * at + 1]} - whole[2 * at] + (vti.in_cells ? 0 : 1));
    raw.spacing[axis] = spacing[at];
    raw.origin[axis] = origin[at];
    for (int row = 0; row < 3; ++row) raw.direction[axis][row] = direction[static_cast<std::size_t>(3 * row + axis)];
    first[axis] = spacing[at] * (whole[2 * at] + (vti.in_cells ? 0.5 : 0.0));
  }
  raw.origin += raw.direction * first;
  return raw;
}

const std::string& attribute(const Attributes& attributes, const char* name, const std::string& otherwise) {
  const auto found = attributes.find(name);
  return found == attributes.end() ? otherwise : found->second;
}

// Keys in VolumeHeader::keys by which the parser tells VtiVoxels where and how the data are stored.
constexpr const char *kDataAt = "vti data at", *kDataIn = "vti data in", *kHeaderType = "vti header type",
                     *kPacked = "vti packed";

VolumeHeader read_vti_header(VolumeFiles& files, const PlainFile& file, const std::string&) {
  const std::string where = files.location().headers.front().string();
  const VtiHeader vti = VtiText(file, where).read();
  VolumeHeader header;
  header.format = "VTK image";
  header.grid = checked_grid(grid_of(vti, where), where, header.warnings);
  const auto type = std::find(kTypes.begin(), kTypes.end(), attribute(vti.array, "type", ""));
  if (type == kTypes.end())
    throw Error("unknown type " + in_quotes(attribute(vti.array, "type", "")), where, "use Int8 to Float64");
  header.voxel_type = static_cast<VoxelType>(type - kTypes.begin());
  header.big_endian = attribute(vti.file, "byte_order", "LittleEndian") == "BigEndian";
  const std::string compressor = attribute(vti.file, "compressor", "");
  if (!compressor.empty() && compressor != kZlib)
    throw Error("the data are compressed by " + in_quotes(compressor), where, "export with zlib or uncompressed");
  const std::string format = attribute(vti.array, "format", "ascii");
  const std::string in = format == "ascii" ? "text" : format == "binary" || vti.appended == "base64" ? "base64" : "raw";
  // `encoding` describes the data in terms that all formats share; the keys tell where they are in the file.
  header.encoding = in == "text" ? Encoding::Ascii : compressor.empty() ? Encoding::Raw : Encoding::Deflate;
  header.keys = {{kDataAt, std::to_string(vti.data_at)},
                 {kDataIn, in},
                 {kHeaderType, attribute(vti.file, "header_type", "UInt32")},
                 {kPacked, compressor.empty() ? "no" : "yes"}};
  return header;
}

// Reads a file's bytes from a given offset on. The bytes are returned as they are, or decoded from base64.
class EncodedBytes {
 public:
  EncodedBytes(PlainFile file, std::int64_t at, bool is_base64, std::string where)
      : file_(std::move(file)),
        at_(at),
        is_base64_(is_base64),
        where_(std::move(where)) {}

  // Reads the next `bytes` bytes into `to`. Throws Error when the data end earlier.
  void read(char* to, std::size_t bytes) {
    while (bytes > 0) {
      if (next_ == ready_.size()) fill();
      const std::size_t some = std::min(bytes, ready_.size() - next_);
      std::memcpy(to, ready_.data() + next_, some);
      next_ += some;
      to += some;
      bytes -= some;
    }
  }
  // Returns the next character of voxel values that are written as text, or 0 at the end of the data.
  char letter() {
    if (next_ == ready_.size() && !fill_raw()) return 0;
    return ready_[next_] == '<' ? 0 : ready_[next_++];
  }
  [[noreturn]] void fail(const char* what) const { throw Error(what, where_, "export or download the file again"); }

 private:
  bool fill_raw() {
    ready_.resize(1 << 16);
    ready_.resize(file_.read_at(at_, ready_.data(), ready_.size()));
    at_ += std::ssize(ready_);
    next_ = 0;
    return !ready_.empty();
  }
  void fill() {
    if (!fill_raw()) fail("the data are cut off");
    if (!is_base64_) return;
    std::string plain;
    for (const char c : ready_) {
      if (is_blank(c)) continue;
      if (c == '<') break;  // start of the closing tag
      const int digit = digit_of(c);
      if (digit < 0 && c != '=') fail("the base64 is damaged");
      group_ = group_ << 6 | static_cast<unsigned>(std::max(digit, 0));
      padding_ += c == '=';
      if (++letters_ < 4) continue;
      if (padding_ > 2) fail("the base64 is damaged");
      for (int byte = 0; byte < 3 - padding_; ++byte) plain += static_cast<char>(group_ >> (16 - 8 * byte) & 255);
      group_ = 0;
      letters_ = padding_ = 0;
    }
    if (plain.empty()) fail("the data are cut off");
    ready_ = std::move(plain);
  }
  static int digit_of(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
  }

  PlainFile file_;
  std::int64_t at_;
  const bool is_base64_;
  const std::string where_;
  std::string ready_;
  std::size_t next_ = 0;
  unsigned group_ = 0;
  int letters_ = 0, padding_ = 0;
};

class VtiVoxels final : public VoxelSource {
 public:
  VtiVoxels(const std::shared_ptr<VolumeFiles>& files, const VolumeHeader& header)
      : bytes_(files->open_header(0), number_of<std::int64_t>(header.keys.at(kDataAt)).value_or(0),
               header.keys.at(kDataIn) == "base64", files->location().headers.front().string()),
        type_(header.voxel_type),
        is_text_(header.keys.at(kDataIn) == "text"),
        is_packed_(header.keys.at(kPacked) == "yes" && !is_text_),
        swaps_(header.big_endian),
        wide_(header.keys.at(kHeaderType) == "UInt64") {
    const std::int64_t promised = header.grid.voxel_count() * size_of(type_);
    if (is_text_) return;
    if (is_packed_) read_sizes(promised);
    else if (static_cast<std::int64_t>(number()) != promised)
      bytes_.fail("the data are not as long as the header says");
  }

  void read(void* to, std::size_t bytes) override {
    char* out = static_cast<char*>(to);
    if (is_text_) return read_text(out, bytes);
    if (!is_packed_) return bytes_.read(out, bytes);
    while (bytes > 0) {
      if (left_in_block_ == 0) begin_block();
      const std::size_t wanted = std::min<std::uint64_t>(bytes, left_in_block_);
      const std::size_t made = inflate_some(out, wanted);
      if (made == 0 && inflater_->ended()) bytes_.fail("a packed block is shorter than it should be");
      left_in_block_ -= made;
      out += made;
      bytes -= made;
    }
  }

  std::vector<std::string> finish() override {
    end_block();
    return {};
  }

 private:
  std::uint64_t number() {
    std::array<unsigned char, 8> of{};
    const std::size_t size = wide_ ? 8 : 4;
    bytes_.read(reinterpret_cast<char*>(of.data()), size);
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value |= std::uint64_t{of[swaps_ ? size - 1 - i : i]} << 8 * i;
    return value;
  }

  // Reads the table in front of the blocks: number of blocks, size of a block and of the last one, compressed sizes.
  void read_sizes(std::int64_t promised) {
    const std::uint64_t blocks = number(), block = number(), last = number();
    constexpr std::uint64_t kMostBlocks = 1 << 22;
    if (blocks > kMostBlocks || block > std::uint64_t{1} << 40 || last > block)
      bytes_.fail("the table of packed blocks is damaged");
    block_bytes_ = block;
    last_bytes_ = last > 0 ? last : block;
    packed_.resize(blocks);
    for (std::uint64_t& size : packed_) size = number();
    const std::uint64_t whole = blocks == 0 ? 0 : (blocks - 1) * block + last_bytes_;
    if (whole != static_cast<std::uint64_t>(promised)) bytes_.fail("the data are not as long as the header says");
  }

  void begin_block() {
    end_block();
    if (at_block_ == packed_.size()) bytes_.fail("the data are cut off");
    left_packed_ = packed_[at_block_++];
    left_in_block_ = at_block_ == packed_.size() ? last_bytes_ : block_bytes_;
    inflater_.emplace();
    waiting_.clear();
  }

  // Ends the current block. Verifies its checksum and its length, then skips the bytes of it that were not read.
  void end_block() {
    char beyond = 0;
    while (inflater_ && !inflater_->ended())
      if (inflate_some(&beyond, 1) > 0) bytes_.fail("a packed block is longer than it should be");
    std::string rest(std::min<std::uint64_t>(left_packed_, 1 << 16), '\0');
    for (; left_packed_ > 0; left_packed_ -= std::min<std::uint64_t>(left_packed_, rest.size()))
      bytes_.read(rest.data(), std::min<std::uint64_t>(left_packed_, rest.size()));
  }

  // Decompresses at most `room` bytes of the current block into `to`. Returns how many bytes were written.
  std::size_t inflate_some(char* to, std::size_t room) {
    if (waiting_.empty() && left_packed_ > 0) {
      waiting_.resize(std::min<std::uint64_t>(left_packed_, 1 << 16));
      bytes_.read(waiting_.data(), waiting_.size());
      left_packed_ -= waiting_.size();
    }
    const bool starved = waiting_.empty();
    const Inflater::Step step = inflater_->inflate(waiting_, to, room);
    waiting_.erase(0, step.taken);
    const bool stands = step.made == 0 && step.taken == 0 && !inflater_->ended();
    if (step.damaged || stands || (starved && step.made == 0)) bytes_.fail("the packed data are damaged");
    return step.made;
  }

  void read_text(char* to, std::size_t bytes) {
    visit_voxel_type(type_, [&]<class T>(T) {
      for (; bytes > 0; bytes -= sizeof(T), to += sizeof(T)) {
        std::string word;
        char c = bytes_.letter();
        while (c != 0 && is_blank(c)) c = bytes_.letter();
        for (; c != 0 && !is_blank(c) && word.size() < 64; c = bytes_.letter()) word += c;
        const auto value = number_of<T>(word);
        if (!value) bytes_.fail(word.empty() ? "the data are cut off" : "a voxel is not a number of its type");
        std::memcpy(to, &*value, sizeof(T));
      }
    });
  }

  EncodedBytes bytes_;
  const VoxelType type_;
  const bool is_text_, is_packed_, swaps_, wide_;
  std::vector<std::uint64_t> packed_;  // compressed size of each block, bytes
  std::uint64_t block_bytes_ = 0, last_bytes_ = 0, left_in_block_ = 0, left_packed_ = 0;
  std::size_t at_block_ = 0;
  std::optional<Inflater> inflater_;
  std::string waiting_;
};

std::unique_ptr<VoxelSource> open_vti_voxels(const std::shared_ptr<VolumeFiles>& files, const VolumeHeader& header) {
  return std::make_unique<VtiVoxels>(files, header);
}

// ---- Writing: the voxels are appended as raw bytes, in blocks of about a megabyte.

constexpr std::uint64_t kBlock = 1 << 20;

std::string vti_text(const Voxels& voxels) {
  const Grid& grid = voxels.grid;
  std::string extent;
  for (int axis = 0; axis < 3; ++axis) extent += (axis ? " 0 " : "0 ") + std::to_string(grid.size[axis] - 1);
  std::string direction;
  for (int row = 0; row < 3; ++row)
    for (int axis = 0; axis < 3; ++axis)
      direction += (direction.empty() ? "" : " ") + text_of(grid.direction[axis][row]);
  const std::string many = voxels.channels > 1 ? " NumberOfComponents=\"" + std::to_string(voxels.channels) + "\"" : "";
  const char* name = voxels.channels > 1 ? "Displacement" : "Labels";
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
         "header_type=\"UInt64\"" +
         (voxels.compress ? " compressor=\"" + std::string(kZlib) + "\"" : "") + ">\n  <ImageData WholeExtent=\"" +
         extent + "\" Origin=\"" + joined(grid.origin) + "\" Spacing=\"" + joined(grid.spacing) + "\" Direction=\"" +
         direction + "\">\n    <Piece Extent=\"" + extent + "\">\n      <PointData " +
         (voxels.channels > 1 ? "Vectors" : "Scalars") + "=\"" + name + "\">\n        <DataArray type=\"" +
         std::string(kTypes[static_cast<std::size_t>(voxels.type)]) + "\" Name=\"" + name + "\"" + many +
         " format=\"appended\" offset=\"0\"/>\n      </PointData>\n    </Piece>\n  </ImageData>\n"
         "  <AppendedData encoding=\"raw\">\n   _";
}

std::string bytes_of(std::uint64_t number) { return {reinterpret_cast<const char*>(&number), sizeof number}; }

void write_blocks(OutputFile& out, const Voxels& voxels) {
  const std::size_t voxel = static_cast<std::size_t>(size_of(voxels.type) * voxels.channels);
  const std::uint64_t total = static_cast<std::uint64_t>(voxels.grid.voxel_count()) * voxel;
  const std::size_t in_block = kBlock / voxel;  // number of voxels in a block (no voxel is split between two blocks)
  const std::uint64_t block = in_block * voxel, blocks = (total + block - 1) / block;
  const std::int64_t table_at = out.place();
  write_text(out, bytes_of(blocks) + bytes_of(block) + bytes_of(total % block) +
                      std::string(static_cast<std::size_t>(8 * blocks), '\0'));
  std::string sizes;
  std::vector<char> bytes(block);
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const auto first = static_cast<std::int64_t>(b * in_block);
    const auto count = static_cast<std::size_t>(
        std::min<std::int64_t>(static_cast<std::int64_t>(in_block), voxels.grid.voxel_count() - first));
    voxels.fill(first, count, bytes.data());
    const std::int64_t before = out.place();
    out.begin_deflate(Deflater::Wrap::Zlib);
    out.write(bytes.data(), count * voxel);
    out.end_deflate();
    sizes += bytes_of(static_cast<std::uint64_t>(out.place() - before));
  }
  out.overwrite(table_at + 24, sizes);
}

void write_vti(const Voxels& voxels, const Path& path) {
  write_atomically(path, [&](const Path& temporary) {
    OutputFile out(temporary);
    write_text(out, vti_text(voxels));
    if (voxels.compress) {
      write_blocks(out, voxels);
    } else {
      const std::int64_t voxel = size_of(voxels.type) * voxels.channels;
      write_text(out, bytes_of(static_cast<std::uint64_t>(voxels.grid.voxel_count() * voxel)));
      write_voxels(out, voxels);
    }
    write_text(out, "\n  </AppendedData>\n</VTKFile>\n");
    out.close();
  });
}

}  // namespace

VolumeFormat vti_format() {
  return {.name = "VTK image",
          .endings = {".vti"},
          .fits =
              [](std::string_view name, std::string_view bytes) {
                return name.ends_with(".vti") || (bytes.substr(0, 1024).find("<VTKFile") != std::string_view::npos &&
                                                  bytes.substr(0, 1024).find("ImageData") != std::string_view::npos);
              },
          .read_header = read_vti_header,
          .open_voxels = open_vti_voxels,
          .written = {{".vti", write_vti}}};
}

}  // namespace limber
