// SPDX-License-Identifier: AGPL-3.0-or-later
#include "render/tiff.h"

#include <algorithm>
#include <cmath>

#include "core/base/deflate.h"

namespace limber::render {

namespace {

constexpr int kRowsPerStrip = 64;

// Appends the `count` lowest bytes of the value, the lowest byte first.
void append(std::string& bytes, std::uint32_t value, int count) {
  for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> 8 * i & 255);
}

// The values of one tag of the file's directory: whole numbers of 16 (SHORT) or 32 bits (LONG), text, or a fraction.
class Directory {
 public:
  void add(int tag, const std::vector<std::uint32_t>& values, int bits = 32) {
    std::string bytes;
    for (const std::uint32_t value : values) append(bytes, value, bits / 8);
    entries_.push_back({tag, bits == 16 ? 3 : 4, static_cast<std::uint32_t>(values.size()), bytes});
  }
  void add_text(int tag, const std::string& text) {
    entries_.push_back({tag, 2, static_cast<std::uint32_t>(text.size() + 1), text + '\0'});
  }
  void add_fraction(int tag, double value) {
    constexpr std::uint32_t kUnder = 1000;
    std::string bytes;
    append(bytes, static_cast<std::uint32_t>(std::lround(value * kUnder)), 4);
    append(bytes, kUnder, 4);
    entries_.push_back({tag, 5, 1, bytes});
  }

  // Returns the bytes of the directory, followed by the values that do not fit into its entries.
  //   at  offset of the directory in the file, bytes
  std::string bytes(std::uint32_t at) const {
    std::string directory, values;
    append(directory, static_cast<std::uint32_t>(entries_.size()), 2);
    const std::uint32_t values_at = at + 2 + 12 * static_cast<std::uint32_t>(entries_.size()) + 4;
    for (const Entry& entry : entries_) {
      append(directory, static_cast<std::uint32_t>(entry.tag), 2);
      append(directory, static_cast<std::uint32_t>(entry.type), 2);
      append(directory, entry.count, 4);
      if (entry.bytes.size() <= 4) {
        directory += entry.bytes + std::string(4 - entry.bytes.size(), '\0');
        continue;
      }
      append(directory, values_at + static_cast<std::uint32_t>(values.size()), 4);
      values += entry.bytes + std::string(entry.bytes.size() % 2, '\0');
    }
    append(directory, 0, 4);  // offset of the next directory; 0: there is no other picture
    return directory + values;
  }

 private:
  struct Entry {
    int tag, type;
    std::uint32_t count;
    std::string bytes;
  };
  std::vector<Entry> entries_;  // the directory's tags and values, sorted by tag
};

// Returns the rows [from, to) of the picture, compressed. Each channel is stored as its difference from the pixel to
// the left.
std::string packed_strip(const Image& image, int channels, int from, int to) {
  std::string packed;
  Deflater deflater(Deflater::Wrap::Zlib,
                    [&](const void* bytes, std::size_t size) { packed.append(static_cast<const char*>(bytes), size); });
  std::string row(static_cast<std::size_t>(image.size.x) * static_cast<std::size_t>(channels), '\0');
  for (int y = from; y < to; ++y) {
    const std::uint8_t* pixels = image.rgba.data() + static_cast<std::size_t>(y) * image.size.x * 4;
    for (int x = 0; x < image.size.x; ++x)
      for (int c = 0; c < channels; ++c)
        row[static_cast<std::size_t>(x * channels + c)] =
            static_cast<char>(pixels[4 * x + c] - (x > 0 ? pixels[4 * (x - 1) + c] : 0));
    deflater.write(row.data(), row.size());
  }
  deflater.end();
  return packed;
}

}  // namespace

std::string tiff_of(const Image& image, double dots_per_inch) {
  bool opaque = true;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) opaque &= image.rgba[i] == 255;
  const int channels = opaque ? 3 : 4;
  std::string file = "II";
  append(file, 42, 2);
  append(file, 0, 4);  // placeholder for the directory's offset, which is written last
  std::vector<std::uint32_t> offsets, sizes;
  for (int y = 0; y < image.size.y; y += kRowsPerStrip) {
    const std::string strip = packed_strip(image, channels, y, std::min(y + kRowsPerStrip, image.size.y));
    offsets.push_back(static_cast<std::uint32_t>(file.size()));
    sizes.push_back(static_cast<std::uint32_t>(strip.size()));
    file += strip + std::string(strip.size() % 2, '\0');
  }
  Directory directory;
  directory.add(256, {static_cast<std::uint32_t>(image.size.x)});
  directory.add(257, {static_cast<std::uint32_t>(image.size.y)});
  // BitsPerSample: 8 for each channel.
  directory.add(258, std::vector<std::uint32_t>(static_cast<std::size_t>(channels), 8), 16);
  directory.add(259, {8}, 16);  // Compression: deflate
  // PhotometricInterpretation: RGB.
  directory.add(262, {2}, 16);
  directory.add(273, offsets);
  directory.add(277, {static_cast<std::uint32_t>(channels)}, 16);
  directory.add(278, {kRowsPerStrip});
  directory.add(279, sizes);
  directory.add_fraction(282, dots_per_inch);
  directory.add_fraction(283, dots_per_inch);
  directory.add(284, {1}, 16);  // PlanarConfiguration: the channels of a pixel are adjacent
  directory.add(296, {2}, 16);  // ResolutionUnit: inch
  directory.add_text(305, "Limber");
  directory.add(317, {2}, 16);               // Predictor: horizontal differences
  if (!opaque) directory.add(338, {2}, 16);  // ExtraSamples: the fourth channel is unassociated alpha
  const auto at = static_cast<std::uint32_t>(file.size());
  std::string place;
  append(place, at, 4);
  file.replace(4, 4, place);
  return file + directory.bytes(at);
}

}  // namespace limber::render
