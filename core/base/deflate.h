// SPDX-License-Identifier: AGPL-3.0-or-later
// Deflate streams (RFC 1951) with a gzip or a zlib wrap, piece by piece. Every stream is closed by its checksum, and
// the checksum is verified.
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
    std::size_t taken = 0, made = 0;  // bytes of the input, bytes put out
    bool damaged = false;
  };
  // Goes on with the stream: gzip or zlib, told apart by its first byte. What was taken may be put out by a later step,
  // so the stream is at a stop only where a step with no input makes nothing.
  Step inflate(std::string_view packed, void* to, std::size_t room);
  bool ended() const { return ended_; }  // and its checksum was right
  std::size_t behind() const {
    return behind_;
  }                   // last bytes of those taken that lie behind the stream, once it has ended
  void start_next();  // another stream may follow

 private:
  struct State;
  std::unique_ptr<State> state_;
  bool begun_ = false, ended_ = false;
  std::size_t behind_ = 0;
};

class Deflater {
 public:
  enum class Wrap { Zlib, Gzip };
  //   put  gets the packed bytes in order
  Deflater(Wrap wrap, std::function<void(const void*, std::size_t)> put);
  ~Deflater();

  void write(const void* bytes, std::size_t size);
  void end();  // after the last byte; once

 private:
  void pump(const void* bytes, std::size_t size, bool last);

  struct State;
  std::unique_ptr<State> state_;
  std::function<void(const void*, std::size_t)> put_;
};

}  // namespace limber
