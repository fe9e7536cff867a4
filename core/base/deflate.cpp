// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/base/deflate.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include <isa-l.h>

namespace limber {

namespace {
// Largest number of bytes passed to the library in one call, because the library counts the bytes of a call in 32 bits.
constexpr std::size_t kMost = std::size_t{1} << 30;
}  // namespace

// The state of a stream being decompressed. The library reads a gzip wrapper itself. With a zlib wrapper (RFC 1950) the
// library would consume bytes beyond the end of the stream, so this class reads that wrapper: a header of two bytes
// before the deflate data and the Adler-32 checksum of four bytes after it.
struct Inflater::State {
  inflate_state stream;
  std::array<std::uint8_t, 2> header;
  std::array<std::uint8_t, 4> trailer;
  std::size_t in_header = 0, in_trailer = 0;  // bytes of the header and of the trailer read so far

  bool is_zlib() const { return stream.crc_flag == ISAL_ZLIB_NO_HDR; }
  bool header_is_right() const {
    return (header[0] & 15) == 8 && (header[0] * 256 + header[1]) % 31 == 0 && !(header[1] & 32);
  }
  bool trailer_is_right() const {
    return stream.crc == (std::uint32_t{trailer[0]} << 24 | std::uint32_t{trailer[1]} << 16 |
                          std::uint32_t{trailer[2]} << 8 | trailer[3]);
  }
};

Inflater::Inflater() : state_(std::make_unique_for_overwrite<State>()) { start_next(); }
Inflater::~Inflater() = default;

void Inflater::start_next() {
  isal_inflate_init(&state_->stream);
  state_->in_header = state_->in_trailer = 0;
  begun_ = ended_ = false;
  behind_ = 0;
}

Inflater::Step Inflater::inflate(std::string_view packed, void* to, std::size_t room) {
  State& state = *state_;
  inflate_state& stream = state.stream;
  if (ended_ || (!begun_ && packed.empty())) return {};
  if (!begun_) {
    stream.crc_flag = packed[0] == '\x1f' ? ISAL_GZIP : ISAL_ZLIB_NO_HDR;
    begun_ = true;
  }
  const std::size_t given = packed.size();
  const auto taken = [&] { return given - packed.size(); };
  const auto take = [&] {
    const auto byte = static_cast<std::uint8_t>(packed[0]);
    packed.remove_prefix(1);
    return byte;
  };
  if (state.is_zlib()) {
    while (state.in_header < state.header.size() && !packed.empty()) state.header[state.in_header++] = take();
    if (state.in_header < state.header.size()) return {taken()};
    if (!state.header_is_right()) return {taken(), 0, true};
  }

  const auto in = static_cast<std::uint32_t>(std::min(packed.size(), kMost)),
             out = static_cast<std::uint32_t>(std::min(room, kMost));
  stream.next_in = reinterpret_cast<std::uint8_t*>(const_cast<char*>(packed.data()));
  stream.avail_in = in;
  stream.next_out = static_cast<std::uint8_t*>(to);
  stream.avail_out = out;
  const int result = isal_inflate(&stream);
  packed.remove_prefix(in - stream.avail_in);
  const std::size_t made = out - stream.avail_out;
  if (result < 0 || result == ISAL_NEED_DICT) return {taken(), made, true};
  if (stream.block_state != ISAL_BLOCK_FINISH) return {taken(), made};

  if (state.is_zlib()) {
    for (; stream.read_in_length >= 8 && state.in_trailer < state.trailer.size();
         stream.read_in_length -= 8, stream.read_in >>= 8)
      state.trailer[state.in_trailer++] = static_cast<std::uint8_t>(stream.read_in >> stream.read_in_length % 8);
    while (state.in_trailer < state.trailer.size() && !packed.empty()) state.trailer[state.in_trailer++] = take();
    if (state.in_trailer < state.trailer.size()) return {taken(), made};
    if (!state.trailer_is_right()) return {taken(), made, true};
  }
  ended_ = true;
  behind_ = state.is_zlib() ? stream.read_in_length / 8 : 0;
  return {taken(), made};
}

// Compresses at level 1, which packs label volumes at 2 GB/s. Higher levels of this library make label volumes no
// smaller. The best level of a general compressor makes them a quarter smaller, in twenty times the time.
struct Deflater::State {
  isal_zstream stream;
  std::array<std::uint8_t, ISAL_DEF_LVL1_DEFAULT> work;
  std::array<std::uint8_t, 1 << 16> packed;
};

Deflater::Deflater(Wrap wrap, std::function<void(const void*, std::size_t)> put)
    : state_(std::make_unique_for_overwrite<State>()),
      put_(std::move(put)) {
  isal_zstream& stream = state_->stream;
  isal_deflate_init(&stream);
  stream.level = 1;
  stream.level_buf = state_->work.data();
  stream.level_buf_size = static_cast<std::uint32_t>(state_->work.size());
  // The gzip header contains no time and no file name, so that the output is the same every time.
  stream.gzip_flag = wrap == Wrap::Gzip ? IGZIP_GZIP : IGZIP_ZLIB;
}
Deflater::~Deflater() = default;

void Deflater::write(const void* bytes, std::size_t size) {
  const auto* from = static_cast<const std::uint8_t*>(bytes);
  for (std::size_t done = 0; done < size; done += kMost) pump(from + done, std::min(size - done, kMost), false);
}

void Deflater::end() { pump(nullptr, 0, true); }

void Deflater::pump(const void* bytes, std::size_t size, bool last) {
  isal_zstream& stream = state_->stream;
  stream.next_in = static_cast<std::uint8_t*>(const_cast<void*>(bytes));
  stream.avail_in = static_cast<std::uint32_t>(size);
  stream.end_of_stream = last;
  do {
    stream.next_out = state_->packed.data();
    stream.avail_out = static_cast<std::uint32_t>(state_->packed.size());
    isal_deflate(&stream);
    put_(state_->packed.data(), state_->packed.size() - stream.avail_out);
  } while (last ? stream.internal_state.state != ZSTATE_END : stream.avail_in > 0 || stream.avail_out == 0);
}

}  // namespace limber
