// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/volume_io/voxel_stream.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <bzlib.h>

#include "core/base/deflate.h"
#include "core/base/error.h"
#include "core/base/text_parse.h"

namespace limber {

namespace {
constexpr std::size_t kChunk = 1 << 16;
// Largest number of bytes into which one byte of compressed data can unpack. A file that is too small for its voxels by
// this number is refused. The limit of deflate is 1032. A bzip2 block of 900 000 bytes takes at least about 40
// compressed bytes.
constexpr std::int64_t kDeflateMost = 1032, kBzip2Most = 25000;

const char* const kExportAgain = "the file is cut off or damaged; export or download it again";

// Reads the bytes of one file in order, through a buffer.
class ByteSource {
 public:
  ByteSource(PlainFile file, const std::string& where) : file_(std::move(file)), where_(where) {}

  std::int64_t size() const { return file_.size(); }
  std::int64_t place() const { return place_ - static_cast<std::int64_t>(end_ - next_); }
  std::int64_t left() const { return size() - place(); }
  const std::string& where() const { return where_; }
  void go_to(std::int64_t place) {
    place_ = place;
    next_ = end_ = 0;
  }
  // Reads the next `bytes` bytes and returns how many bytes were read. These are fewer only at the file's end. Bytes
  // that are not in the buffer are read directly into `to`.
  std::size_t read(void* to, std::size_t bytes) {
    std::size_t done = std::min(bytes, end_ - next_);
    std::memcpy(to, buffer_.data() + next_, done);
    next_ += done;
    if (done < bytes) {
      const std::size_t more = file_.read_at(place_, static_cast<char*>(to) + done, bytes - done);
      place_ += static_cast<std::int64_t>(more);
      done += more;
    }
    return done;
  }
  // Returns the buffered bytes that are not consumed yet. Refills the buffer first when it is empty. Returns no bytes
  // at the end of the file.
  std::string_view peek() {
    if (next_ == end_) {
      end_ = file_.read_at(place_, buffer_.data(), buffer_.size());
      place_ += static_cast<std::int64_t>(end_);
      next_ = 0;
    }
    return {reinterpret_cast<const char*>(buffer_.data()) + next_, end_ - next_};
  }
  void pass(std::size_t bytes) { next_ += bytes; }

 private:
  PlainFile file_;
  std::string where_;
  std::array<unsigned char, kChunk> buffer_{};
  std::size_t next_ = 0, end_ = 0;
  std::int64_t place_ = 0;
};

// Base class of the decoders; each encoding has one. read() returns the number of decoded bytes, which is below `bytes`
// only at the end of the data, and throws Error when the data are damaged.
class Decoder {
 public:
  explicit Decoder(ByteSource& source) : source_(source) {}
  virtual ~Decoder() = default;
  virtual std::size_t read(unsigned char* to, std::size_t bytes) = 0;
  // Returns true if no data follow the bytes that were read. Throws Error when a checksum at the end of the data is
  // wrong.
  virtual bool ends_here() {
    unsigned char more;
    return read(&more, 1) == 0;
  }

 protected:
  [[noreturn]] void damaged(const std::string& what) const { throw Error(what, source_.where(), kExportAgain); }
  ByteSource& source_;
};

class RawDecoder final : public Decoder {
 public:
  using Decoder::Decoder;
  std::size_t read(unsigned char* to, std::size_t bytes) override { return source_.read(to, bytes); }
};

class DeflateDecoder final : public Decoder {
 public:
  using Decoder::Decoder;

  std::size_t read(unsigned char* to, std::size_t bytes) override {
    std::size_t done = 0;
    while (done < bytes && !ended_) {
      const std::string_view input = source_.peek();
      const Inflater::Step step = stream_.inflate(input, to + done, bytes - done);
      if (step.damaged) damaged("the compressed data are damaged");
      source_.pass(step.taken);
      done += step.made;
      if (stream_.ended()) start_next_member();
      else if (input.empty() && step.made == 0) return done;
    }
    return done;
  }
  bool ends_here() override {
    unsigned char more;
    if (read(&more, 1) > 0) return false;
    if (!ended_) damaged("the compressed data are cut off before their checksum");
    return true;
  }

 private:
  // Starts the next gzip stream. A gzip file may contain several streams in a row; pigz and bgzip write such files.
  void start_next_member() {
    if (stream_.behind() > 0) source_.go_to(source_.place() - static_cast<std::int64_t>(stream_.behind()));
    const std::string_view rest = source_.peek();
    if (rest.size() >= 2 && rest[0] == '\x1f' && rest[1] == '\x8b') stream_.start_next();
    else ended_ = true;
  }

  Inflater stream_;
  bool ended_ = false;
};

class Bzip2Decoder final : public Decoder {
 public:
  explicit Bzip2Decoder(ByteSource& source) : Decoder(source) {
    if (BZ2_bzDecompressInit(&stream_, 0, 0) != BZ_OK) throw std::bad_alloc();
  }
  ~Bzip2Decoder() override { BZ2_bzDecompressEnd(&stream_); }

  std::size_t read(unsigned char* to, std::size_t bytes) override {
    std::size_t done = 0;
    while (done < bytes && !ended_) {
      const std::string_view input = source_.peek();
      if (input.empty()) return done;
      stream_.next_in = const_cast<char*>(input.data());
      stream_.avail_in = static_cast<unsigned>(input.size());
      stream_.next_out = reinterpret_cast<char*>(to) + done;
      const auto wanted = static_cast<unsigned>(std::min<std::size_t>(bytes - done, 1 << 30));
      stream_.avail_out = wanted;
      const int result = BZ2_bzDecompress(&stream_);
      source_.pass(input.size() - stream_.avail_in);
      done += wanted - stream_.avail_out;
      if (result == BZ_STREAM_END) ended_ = true;
      else if (result != BZ_OK) damaged("the compressed data are damaged");
    }
    return done;
  }
  bool ends_here() override {
    unsigned char more;
    if (read(&more, 1) > 0) return false;
    if (!ended_) damaged("the compressed data are cut off before their checksum");
    return true;
  }

 private:
  bz_stream stream_{};
  bool ended_ = false;
};

// Converts numbers in a text to voxels in memory. Blanks or commas separate the numbers.
class AsciiDecoder final : public Decoder {
 public:
  AsciiDecoder(ByteSource& source, VoxelType type, bool big_endian) : Decoder(source), type_(type), swap_(big_endian) {}

  std::size_t read(unsigned char* to, std::size_t bytes) override {
    std::size_t done = 0;
    while (done < bytes) {
      if (next_ == end_ && !take_number()) break;
      const std::size_t now = std::min(bytes - done, end_ - next_);
      std::memcpy(to + done, value_.data() + next_, now);
      next_ += now;
      done += now;
    }
    return done;
  }

 private:
  bool take_number() {
    std::array<char, 400> text;
    std::size_t length = 0;
    for (;;) {
      const std::string_view input = source_.peek();
      if (input.empty()) break;
      const char c = input[0];
      source_.pass(1);
      if (is_blank(c) || c == ',') {
        if (length > 0) break;
        continue;
      }
      if (length == text.size()) damaged("the text data hold a word that is not a number");
      text[length++] = c;
    }
    if (length == 0) return false;
    store({text.data(), length});
    return true;
  }
  template <class T>
  void store_as(std::string_view text) {
    auto value = number_of<T>(text);
    if (!value && std::is_integral_v<T>)  // also accepts a whole number with decimals, such as "3.0"
      if (const auto real = number_of<double>(text);
          real && *real == static_cast<double>(static_cast<std::int32_t>(std::clamp(*real, -2e9, 2e9))))
        if (const auto whole = static_cast<std::int64_t>(*real);
            whole == static_cast<std::int64_t>(static_cast<T>(whole)))
          value = static_cast<T>(whole);
    if (!value) damaged("the text data hold " + in_quotes(text) + ", which does not fit the voxel type");
    std::memcpy(value_.data(), &*value, sizeof(T));
    if (swap_) std::reverse(value_.begin(), value_.begin() + sizeof(T));
    next_ = 0;
    end_ = sizeof(T);
  }
  void store(std::string_view text) {
    switch (type_) {
      case VoxelType::Int8: return store_as<std::int8_t>(text);
      case VoxelType::UInt8: return store_as<std::uint8_t>(text);
      case VoxelType::Int16: return store_as<std::int16_t>(text);
      case VoxelType::UInt16: return store_as<std::uint16_t>(text);
      case VoxelType::Int32: return store_as<std::int32_t>(text);
      case VoxelType::UInt32: return store_as<std::uint32_t>(text);
      case VoxelType::Int64: return store_as<std::int64_t>(text);
      case VoxelType::UInt64: return store_as<std::uint64_t>(text);
      case VoxelType::Float32: return store_as<float>(text);
      case VoxelType::Float64: return store_as<double>(text);
    }
  }

  VoxelType type_;
  bool swap_;
  std::array<unsigned char, 8> value_{};
  std::size_t next_ = 0, end_ = 0;
};

class HexDecoder final : public Decoder {
 public:
  using Decoder::Decoder;
  std::size_t read(unsigned char* to, std::size_t bytes) override {
    std::size_t done = 0;
    while (done < bytes) {
      const int high = digit(), low = high < 0 ? -1 : digit();
      if (high >= 0 && low < 0) damaged("the hexadecimal data end within a byte");
      if (high < 0) break;
      to[done++] = static_cast<unsigned char>(high * 16 + low);
    }
    return done;
  }

 private:
  int digit() {
    for (;;) {
      const std::string_view input = source_.peek();
      if (input.empty()) return -1;
      const char c = input[0];
      source_.pass(1);
      if (c >= '0' && c <= '9') return c - '0';
      if (c >= 'a' && c <= 'f') return c - 'a' + 10;
      if (c >= 'A' && c <= 'F') return c - 'A' + 10;
      if (!is_blank(c)) damaged("the hexadecimal data hold " + in_quotes({&c, 1}));
    }
  }
};

std::unique_ptr<Decoder> make_decoder(ByteSource& source, const VolumeHeader& header) {
  switch (header.encoding) {
    case Encoding::Raw: return std::make_unique<RawDecoder>(source);
    case Encoding::Deflate: return std::make_unique<DeflateDecoder>(source);
    case Encoding::Bzip2: return std::make_unique<Bzip2Decoder>(source);
    case Encoding::Ascii: return std::make_unique<AsciiDecoder>(source, header.voxel_type, header.big_endian);
    case Encoding::Hex: return std::make_unique<HexDecoder>(source);
  }
  return nullptr;
}

void go_to_data(ByteSource& source, const VolumeHeader& header, std::int64_t raw_bytes) {
  if (header.byte_skip < 0) {
    source.go_to(std::max<std::int64_t>(0, source.size() - raw_bytes));
    return;
  }
  for (std::int64_t line = 0; line < header.line_skip;) {
    const std::string_view input = source.peek();
    if (input.empty()) throw Error("the data file has fewer lines than `line skip`", source.where(), kExportAgain);
    const std::size_t end = input.find('\n');
    line += end != std::string_view::npos;
    source.pass(end == std::string_view::npos ? input.size() : end + 1);
  }
  if (header.byte_skip > source.left())
    throw Error("the data begin beyond the file's end", source.where(), kExportAgain);
  source.go_to(source.place() + header.byte_skip);
}

// Throws Error when the file is too small to contain `bytes` bytes of decoded voxels. Call this before memory is
// allocated for them.
void check_room(const ByteSource& source, const VolumeHeader& header, std::int64_t bytes) {
  const std::int64_t there = source.left(), voxel = size_of(header.voxel_type);
  std::int64_t most = there;
  switch (header.encoding) {
    case Encoding::Raw: break;
    case Encoding::Deflate: most = there * kDeflateMost; break;
    case Encoding::Bzip2: most = there * kBzip2Most; break;
    case Encoding::Ascii: most = (there / 2 + 1) * voxel; break;
    case Encoding::Hex: most = there / 2; break;
  }
  if (most < bytes + header.decoded_skip)
    throw Error("the header promises " + std::to_string(bytes) + " bytes of voxels, the file holds " +
                    std::to_string(there) + (header.encoding == Encoding::Raw ? "" : " encoded bytes, too few"),
                source.where(), kExportAgain);
}
}  // namespace

struct VoxelStream::Sources {
  std::shared_ptr<VolumeFiles> files;
  const VolumeHeader header;
  std::int64_t bytes_each = 0;
  std::int64_t current = 0;  // index of the current data file
  std::int64_t left = 0;     // encoded bytes left in the current data file
  std::unique_ptr<ByteSource> source;
  std::unique_ptr<Decoder> decoder;
  std::int64_t data_start = 0;
  std::vector<std::string> warnings;

  std::int64_t count() const { return std::max<std::int64_t>(1, std::ssize(header.data_names)); }
  void open() {
    decoder.reset();
    const VolumeLocation& location = files->location();
    if (header.data_names.empty()) {
      source = std::make_unique<ByteSource>(files->open_header(0), location.headers.front().string());
    } else {
      const std::string& name = header.data_names[static_cast<std::size_t>(current)];
      source = std::make_unique<ByteSource>(files->open_data(name), (location.folder() / name).string());
    }
    go_to_data(*source, header, bytes_each);
    check_room(*source, header, bytes_each);
    data_start = source->place();
    decoder = make_decoder(*source, header);
    left = bytes_each;
    pass_decoded(header.decoded_skip);
  }
  void open_next() {
    close();
    ++current;
    if (current == count())
      throw Error("more voxels were requested than the header states", source->where(), kExportAgain);
    open();
  }
  void pass_decoded(std::int64_t bytes) {
    std::array<unsigned char, 4096> sink;
    while (bytes > 0) {
      const std::size_t got =
          decoder->read(sink.data(), static_cast<std::size_t>(std::min<std::int64_t>(bytes, sink.size())));
      if (got == 0) throw Error("the data end before the first voxel", source->where(), kExportAgain);
      bytes -= static_cast<std::int64_t>(got);
    }
  }
  void close() {
    if (!decoder->ends_here() && header.byte_skip >= 0)
      warnings.push_back("more data than the header promises: " + source->where() + ": the rest is ignored");
    if (header.compressed_bytes && current == 0) {
      const std::int64_t used = source->place() - data_start;
      if (*header.compressed_bytes != used)
        warnings.push_back("the header says " + std::to_string(*header.compressed_bytes) +
                           " compressed bytes, the data have " + std::to_string(used) + ": " + source->where() +
                           ": all of them are read");
    }
  }
};

VoxelStream::VoxelStream(std::shared_ptr<VolumeFiles> files, const VolumeHeader& header)
    : sources_(new Sources{std::move(files), header, 0, 0, 0, {}, {}, 0, {}}) {
  VolumeFiles& from = *sources_->files;
  from.check_data(header.data_names);
  const std::int64_t bytes = header.grid.voxel_count() * size_of(header.voxel_type), count = sources_->count();
  if (header.grid.voxel_count() % count != 0)
    throw Error("the voxels cannot be shared evenly by " + std::to_string(count) + " data files",
                from.location().headers.front().string(), "list one file per slice");
  sources_->bytes_each = bytes / count;
  sources_->open();
}

VoxelStream::~VoxelStream() = default;

std::optional<FileBytes> VoxelStream::pass_plain() {
  Sources& s = *sources_;
  if (s.header.encoding != Encoding::Raw) return std::nullopt;
  if (s.left == 0) s.open_next();
  const FileBytes plain{s.source->place(), s.left};
  s.source->go_to(plain.offset + plain.bytes);
  s.left = 0;
  return plain;
}

void VoxelStream::read(void* to, std::size_t bytes) {
  auto* out = static_cast<unsigned char*>(to);
  Sources& s = *sources_;
  while (bytes > 0) {
    if (s.left == 0) s.open_next();
    const std::size_t now = static_cast<std::size_t>(std::min<std::int64_t>(static_cast<std::int64_t>(bytes), s.left));
    const std::size_t got = s.decoder->read(out, now);
    if (got < now)
      throw Error("the data end after " + std::to_string(s.bytes_each - s.left + static_cast<std::int64_t>(got)) +
                      " of " + std::to_string(s.bytes_each) + " bytes",
                  s.source->where(), kExportAgain);
    out += got;
    bytes -= got;
    s.left -= static_cast<std::int64_t>(got);
  }
}

std::vector<std::string> VoxelStream::finish() {
  sources_->close();
  return std::move(sources_->warnings);
}

}  // namespace limber
