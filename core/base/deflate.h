// SPDX-License-Identifier: AGPL-3.0-or-later
// Reads and writes deflate streams (RFC 1951) with a gzip or zlib wrapper, in pieces. Each stream ends with a checksum,
// which the reader verifies.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string_view>

namespace limber {

class Inflater {
 public:
  Inflater();
  ~Inflater();

  struct Step {
    std::size_t taken = 0, made = 0;  // number of input bytes consumed, and of output bytes written
    bool damaged = false;
  };
  // Decompresses the next bytes of the stream into `to`, at most `room` bytes. The stream's first byte tells gzip from
  // zlib. The output of consumed bytes may be written only by a later step. So call this again with no input until a
  // step writes no bytes.
  Step inflate(std::string_view packed, void* to, std::size_t room);
  bool ended() const { return ended_; }  // true after the end of the stream, if its checksum was right
  // Returns how many of the input bytes that the last inflate() consumed lie beyond the end of the stream. Call it when
  // ended() is true.
  std::size_t behind() const { return behind_; }
  void start_next();  // resets the object for another stream

 private:
  struct State;
  std::unique_ptr<State> state_;
  bool begun_ = false, ended_ = false;
  std::size_t behind_ = 0;
};

class Deflater {
 public:
  enum class Wrap { Zlib, Gzip };
  // Creates a compressor; `put` receives the packed bytes in order.
  Deflater(Wrap wrap, std::function<void(const void*, std::size_t)> put);
  ~Deflater();

  void write(const void* bytes, std::size_t size);
  void end();  // writes the end of the stream; call it once, after the last byte

 private:
  void pump(const void* bytes, std::size_t size, bool last);

  struct State;
  std::unique_ptr<State> state_;
  std::function<void(const void*, std::size_t)> put_;
};

}  // namespace limber
