// SPDX-License-Identifier: AGPL-3.0-or-later
// Writes pictures as a video, .mp4 (H.264) or .webm (VP9), through the program ffmpeg where it is installed. The
// pictures go to its standard input as they are drawn; no shell is involved.
#pragma once

#include <memory>

#include "core/base/file.h"
#include "core/base/progress.h"
#include "render/image_io.h"

namespace limber::editor {

inline constexpr int kPicturesPerSecond = 24;

bool is_video(const Path& path);  // by the name's ending
// Throws Error when ffmpeg is not installed.
void require_ffmpeg(const Path& path);

class Video {
 public:
  // Starts ffmpeg. The video appears at `path` only when finish() is called; until then it grows in a folder of its own
  // below `scratch` ("": the system's folder for temporary files). Throws Error when ffmpeg is not installed or fails.
  Video(const Path& path, const glm::ivec2& size, const std::string& scratch, Progress& progress);
  ~Video();  // ends ffmpeg; without finish(), no file is left
  Video(const Video&) = delete;
  Video& operator=(const Video&) = delete;

  void add(const render::Image& picture);  // of the size given before
  void finish();

 private:
  struct Encoder;
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace limber::editor
