// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes pictures as a video, .mp4 (H.264) or .webm (VP9), by the program ffmpeg if it is installed. Pictures are
// written to ffmpeg's standard input as soon as they are drawn. ffmpeg is started without a shell.
#pragma once

#include <memory>

#include "core/base/file.h"
#include "core/base/progress.h"
#include "render/image_io.h"

namespace limber::editor {

inline constexpr int kPicturesPerSecond = 24;

bool is_video(const Path& path);  // returns true if the file name ends in .mp4 or .webm
// Throws Error when ffmpeg is not installed.
void require_ffmpeg(const Path& path);

class Video {
 public:
  // Starts ffmpeg. The video is written to a temporary folder below `scratch` ("": the system's folder for temporary
  // files), and finish() moves it to `path`. Throws Error if ffmpeg is not installed or fails.
  Video(const Path& path, const glm::ivec2& size, const std::string& scratch, Progress& progress);
  ~Video();  // ends ffmpeg; if finish() was not called, no file is left
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;

  void add(const render::Image& picture);  // the picture must have the size given to the constructor
  void finish();

 private:
  struct Encoder;
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace limber::editor
