// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/figure/video.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"
#include "core/base/text_parse.h"
#include "core/platform/child_program.h"
#include "core/platform/module.h"
#include "core/platform/pipe.h"
#include "editor/file_browser/temp_folder.h"

namespace limber::editor {

namespace {

constexpr int kPollMilliseconds = 50;
constexpr std::size_t kMostComplaint = 4000;  // largest number of bytes of ffmpeg's error messages that are kept

std::string ending_of_video(const Path& path) { return lower_case(path.extension().string()); }

// Returns the command line of ffmpeg, which reads raw pictures from its standard input. Width and height are padded to
// even numbers, because the 4:2:0 colours of both video formats need them.
std::vector<std::string> words_for(const Path& made, const glm::ivec2& size) {
  std::vector<std::string> words = {"ffmpeg",
                                    "-nostdin",
                                    "-hide_banner",
                                    "-loglevel",
                                    "error",
                                    "-y",
                                    "-f",
                                    "rawvideo",
                                    "-pixel_format",
                                    "rgba",
                                    "-video_size",
                                    std::to_string(size.x) + "x" + std::to_string(size.y),
                                    "-framerate",
                                    std::to_string(kPicturesPerSecond),
                                    "-i",
                                    "pipe:0",
                                    "-an",
                                    "-vf",
                                    "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                    "-pix_fmt",
                                    "yuv420p"};
  if (made.extension() == ".webm") words.insert(words.end(), {"-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0"});
  else words.insert(words.end(), {"-c:v", "libx264", "-crf", "18", "-movflags", "+faststart"});
  words.push_back("file:" + made.string());
  return words;
}

Path ffmpeg_for(const Path& path) {
  const auto program = find_program("ffmpeg");
  if (!program)
    throw Error("a video needs the program ffmpeg, which is not installed", path.string(),
                "install ffmpeg, or use a name that ends in .png for numbered pictures");
  return *program;
}

}  // namespace

bool is_video(const Path& path) {
  const std::string ending = ending_of_video(path);
  return ending == ".mp4" || ending == ".webm";
}

void require_ffmpeg(const Path& path) { ffmpeg_for(path); }

struct Video::Encoder {
  Path path;
  glm::ivec2 size;
  Progress& progress;
  ScratchFolder folder;
  Path made = folder.path() / ("video" + ending_of_video(path));
  FileChannel pictures;
  Pipe errors;
  std::unique_ptr<ChildProgram> program;
  std::string complaint;

  Encoder(const Path& to, const glm::ivec2& picture, const std::string& scratch, Progress& told)
      : path(to),
        size(picture),
        progress(told),
        folder(scratch) {
    const Path ffmpeg = ffmpeg_for(path);
    std::error_code error;
    pictures = make_file_channel(error);
    if (!error) errors = make_pipe(error);
    if (!error) {
      const Streams streams{.in = &pictures.its, .err = &errors.write_end};
      program = std::make_unique<ChildProgram>(ffmpeg, words_for(made, size), streams, Environment::Same, error);
    }
    if (error) throw Error("ffmpeg cannot be started", ffmpeg.string(), error.message());
    pictures.its.close();
    errors.write_end.close();
  }

  void listen() {
    char bytes[1024];
    for (std::ptrdiff_t count; (count = read_some(errors.read_end, bytes, sizeof bytes)) > 0;)
      complaint.append(bytes, std::min(static_cast<std::size_t>(count),
                                       kMostComplaint - std::min(kMostComplaint, complaint.size())));
  }
  // Returns an Error with the first line of ffmpeg's error messages.
  Error failure() {
    listen();
    const std::string line = complaint.substr(0, complaint.find('\n'));
    return {"ffmpeg could not make the video", path.string(),
            line.empty() ? "ffmpeg gave no reason; use a name that ends in .png for numbered pictures" : line};
  }
  void send(std::string_view bytes) {
    while (!bytes.empty()) {
      if (progress.cancelled()) throw Cancelled();
      listen();
      const std::ptrdiff_t sent = send_some(pictures.ours, bytes, nullptr);
      if (sent == 0) throw failure();
      if (sent > 0) bytes.remove_prefix(static_cast<std::size_t>(sent));
      else wait_to_write(pictures.ours, kPollMilliseconds);
    }
  }
};

Video::Video(const Path& path, const glm::ivec2& size, const std::string& scratch, Progress& progress)
    : encoder_(std::make_unique<Encoder>(path, size, scratch, progress)) {}
Video::~Video() = default;

void Video::add(const render::Image& picture) {
  encoder_->send({reinterpret_cast<const char*>(picture.rgba.data()), picture.rgba.size()});
}

void Video::finish() {
  Encoder& my = *encoder_;
  my.pictures.ours.close();  // closing the pipe tells ffmpeg that there are no more pictures
  while (!my.program->has_ended()) {
    if (my.progress.cancelled()) throw Cancelled();
    wait_to_read({&my.errors.read_end}, kPollMilliseconds);
    my.listen();
  }
  if (my.program->end().by_signal() || my.program->end().exit_code != 0) throw my.failure();
  write_file_atomically(my.path, read_file(my.made));
}

}  // namespace limber::editor
