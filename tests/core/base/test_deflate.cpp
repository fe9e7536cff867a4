// SPDX-License-Identifier: AGPL-3.0-or-later
#include <doctest/doctest.h>

#include <random>
#include <string>

#include <zlib.h>

#include "core/base/deflate.h"

using namespace limber;

namespace {

std::string runs_of_labels(std::size_t size, unsigned seed) {
  std::mt19937 random(seed);
  std::string bytes;
  while (bytes.size() < size) bytes.append(1 + random() % 300, static_cast<char>(random() % 12));
  bytes.resize(size);
  return bytes;
}

std::string noise(std::size_t size) {
  std::mt19937 random(9);
  std::string bytes(size, '\0');
  for (char& b : bytes) b = static_cast<char>(random());
  return bytes;
}

std::string packed(const std::string& bytes, Deflater::Wrap wrap, std::size_t piece) {
  std::string stream;
  Deflater deflater(wrap,
                    [&](const void* put, std::size_t size) { stream.append(static_cast<const char*>(put), size); });
  for (std::size_t i = 0; i < bytes.size(); i += piece)
    deflater.write(bytes.data() + i, std::min(piece, bytes.size() - i));
  deflater.end();
  return stream;
}

// Compresses by zlib, as the reference.
std::string packed_elsewhere(const std::string& bytes, int window_bits, int level) {
  z_stream stream{};
  deflateInit2(&stream, level, Z_DEFLATED, window_bits, 8, Z_DEFAULT_STRATEGY);
  std::string result(deflateBound(&stream, bytes.size()) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  deflate(&stream, Z_FINISH);
  result.resize(stream.total_out);
  deflateEnd(&stream);
  return result;
}

std::string unpacked_elsewhere(const std::string& stream_bytes, std::size_t size) {
  z_stream stream{};
  inflateInit2(&stream, 15 + 32);
  std::string result(size + 1, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(stream_bytes.data()));
  stream.avail_in = static_cast<uInt>(stream_bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(result.data());
  stream.avail_out = static_cast<uInt>(result.size());
  const int end = inflate(&stream, Z_FINISH);
  result.resize(stream.total_out);
  inflateEnd(&stream);
  return end == Z_STREAM_END ? result : "damaged";
}

struct Unpacked {
  std::string bytes;
  std::size_t taken = 0;
  bool ended = false, damaged = false;
};

Unpacked unpacked(std::string_view stream, std::size_t piece, std::size_t room) {
  Inflater inflater;
  Unpacked result;
  std::string out(room, '\0');
  while (!inflater.ended()) {
    const Inflater::Step step = inflater.inflate(stream.substr(result.taken, piece), out.data(), room);
    result.bytes.append(out, 0, step.made);
    result.taken += step.taken;
    result.damaged = step.damaged;
    if (step.damaged || step.taken + step.made == 0) break;
  }
  result.ended = inflater.ended();
  result.taken -= inflater.behind();
  return result;
}

}  // namespace

TEST_CASE("deflate: what was packed comes back, however it is cut into pieces, here and in zlib") {
  for (const std::string& bytes : {std::string(), std::string("a"), runs_of_labels(300000, 1), noise(70000)})
    for (const auto wrap : {Deflater::Wrap::Zlib, Deflater::Wrap::Gzip}) {
      const std::string stream = packed(bytes, wrap, 16384);
      CHECK(stream == packed(bytes, wrap, 16384));
      CHECK(unpacked_elsewhere(stream, bytes.size()) == bytes);
      CHECK(unpacked_elsewhere(packed(bytes, wrap, 7 + bytes.size() / 50), bytes.size()) == bytes);
      for (const std::size_t piece : {1, 7, 65536})
        for (const std::size_t room : {1, 1000, 1 << 20}) {
          if (piece == 1 && room == 1 && bytes.size() > 100000) continue;
          const Unpacked back = unpacked(stream, piece, room);
          CHECK(back.ended);
          CHECK(back.bytes == bytes);
          CHECK(back.taken == stream.size());
        }
    }
}

TEST_CASE("deflate: zlib's streams are read, and what is behind them is left") {
  const std::string bytes = runs_of_labels(100000, 2),
                    behind = "what follows is another's, and long enough to be noticed";
  for (const int window_bits : {15, 15 + 16, 9})
    for (const int level : {0, 1, 6, 9}) {
      const std::string stream = packed_elsewhere(bytes, window_bits, level);
      for (const std::size_t piece : {1, 3, 999, 1 << 20}) {
        const Unpacked back = unpacked(stream + behind, piece, 4096);
        CHECK(back.ended);
        CHECK(back.bytes == bytes);
        INFO("window ", window_bits, " level ", level, " piece ", piece);
        CHECK(back.taken == stream.size());
      }
    }
}

TEST_CASE("deflate: a stream that is cut off never ends, and one with another bit is damaged") {
  const std::string bytes = runs_of_labels(5000, 3);
  for (const auto wrap : {Deflater::Wrap::Zlib, Deflater::Wrap::Gzip}) {
    const std::string stream = packed(bytes, wrap, 1000);
    for (std::size_t size = 0; size < stream.size(); ++size)
      CHECK_FALSE(unpacked(std::string_view(stream).substr(0, size), 100, 512).ended);
    // The 10 bytes of the gzip header are skipped: some of its fields have no effect on the data.
    for (std::size_t at = wrap == Deflater::Wrap::Gzip ? 10 : 0; at < stream.size(); ++at)
      for (int bit = 0; bit < 8; ++bit) {
        std::string wrong = stream;
        wrong[at] = static_cast<char>(wrong[at] ^ 1 << bit);
        const Unpacked back = unpacked(wrong, 100, 512);
        INFO("byte ", at, " bit ", bit, " wrap ", int(wrap));
        CHECK((!back.ended || back.bytes == bytes));
      }
  }
}

TEST_CASE("deflate: streams one after the other are read one after the other") {
  const std::string one = runs_of_labels(4000, 4), two = noise(3000);
  const std::string streams = packed(one, Deflater::Wrap::Gzip, 500) + packed_elsewhere(two, 15 + 16, 6);
  Inflater inflater;
  std::string out(10000, '\0'), all;
  for (std::string_view rest = streams; !rest.empty();) {
    const Inflater::Step step = inflater.inflate(rest.substr(0, 100), out.data(), 64);
    all.append(out, 0, step.made);
    rest.remove_prefix(step.taken - inflater.behind());
    if (inflater.ended()) inflater.start_next();
    REQUIRE_FALSE(step.damaged);
  }
  for (Inflater::Step step{1, 1}; step.made > 0; all.append(out, 0, step.made))
    step = inflater.inflate({}, out.data(), 64);
  CHECK(all == one + two);
}
