// SPDX-License-Identifier: AGPL-3.0-or-later
// Tests VTK images: files that are written out here in each form that VTK writes, files that the program writes and
// reads back, and damaged files.
#include <cstring>
#include <filesystem>
#include <fstream>

#include <doctest/doctest.h>
#include <zlib.h>

#include "core/base/error.h"
#include "core/volume_io/volume_io.h"

using namespace limber;

namespace {

Path file_with(const char* name, const std::string& text) {
  const Path path = std::filesystem::temp_directory_path() / (std::string("limber-") + name + ".vti");
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

// Returns an image of 2 x 3 x 1 points with the given data array.
std::string image(const std::string& array, const std::string& behind = "", const std::string& file_attributes = "",
                  const std::string& in = "PointData") {
  const std::string extent = in == "PointData" ? "2 3 0 2 0 0" : "2 4 0 3 0 1";
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" " +
         file_attributes + "><ImageData WholeExtent=\"" + extent +
         "\" Origin=\"10 20 30\" Spacing=\"2 3 4\"><Piece Extent=\"" + extent + "\"><" + in + ">" + array + "</" + in +
         "></Piece></ImageData>" + behind + "</VTKFile>";
}

const std::vector<Label> kLabels = {0, 1, 2, 3, 0, 200};

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63];
  }
  return text;
}

template <class T>
std::string bytes_of(std::initializer_list<T> values) {
  std::string bytes;
  for (const T value : values) bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  return bytes;
}

const std::string kShorts = bytes_of<std::uint16_t>({0, 1, 2, 3, 0, 200});

std::string packed(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string out(size, '\0');
  compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
           static_cast<uLong>(bytes.size()));
  out.resize(size);
  return out;
}

void check_labels(const Path& path) {
  const VolumeFile file = read_volume(path);
  CHECK(file.type.format == "VTK image");
  CHECK(file.volume.grid.size == glm::ivec3(2, 3, 1));
  CHECK(file.volume.grid.spacing == glm::dvec3(2, 3, 4));
  CHECK(file.volume.grid.origin == glm::dvec3(14, 20, 30));  // position of the extent's first point
  std::vector<double> values;
  for (const Label label : file.volume.voxels) values.push_back(label == 0 ? 0 : file.tissues.find(label)->file_value);
  CHECK(values == std::vector<double>(kLabels.begin(), kLabels.end()));
}

std::string problem_of(const Path& path) {
  try {
    read_volume(path);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace

TEST_CASE("vti: numbers, base64, raw and packed data are the same image") {
  check_labels(file_with("ascii", image(R"(<DataArray type="UInt8" Name="a" format="ascii"> 0 1 2
    3 0 200 </DataArray>)")));
  check_labels(file_with("binary", image(R"(<DataArray type="UInt16" Name="a" format="binary">)" +
                                         base64(bytes_of<std::uint32_t>({12}) + kShorts) + "</DataArray>")));
  const std::string array = R"(<DataArray type="UInt16" Name="a" format="appended" offset="2"/>)";
  check_labels(file_with("raw", image(array,
                                      "<AppendedData encoding=\"raw\">\n _xx" + bytes_of<std::uint64_t>({12}) +
                                          kShorts + "</AppendedData>",
                                      R"(header_type="UInt64")")));
  const std::string a = packed(kShorts.substr(0, 8)), b = packed(kShorts.substr(8));
  const auto length = [](const std::string& bytes) { return static_cast<std::uint32_t>(bytes.size()); };
  const std::string table = bytes_of<std::uint32_t>({2, 8, 4, length(a), length(b)});
  const std::string zlib = R"(compressor="vtkZLibDataCompressor" header_type="UInt32")";
  check_labels(file_with("packed",
                         image(array, "<AppendedData encoding=\"raw\">_xx" + table + a + b + "</AppendedData>", zlib)));
  check_labels(file_with("packed-text", image(R"(<DataArray type="UInt16" Name="a" format="binary">)" + base64(table) +
                                                  base64(a + b) + "</DataArray>",
                                              "", zlib)));
}

TEST_CASE("vti: cells lie half a spacing further on, and the named scalars are taken") {
  const Path path =
      file_with("cells", image(R"(<DataArray type="Float32" Name="x" format="ascii">9 9 9 9 9 9</DataArray>
    <DataArray type="UInt8" Name="labels" format="ascii">0 1 2 3 0 200</DataArray>)",
                               "", "", "CellData Scalars=\"labels\""));
  std::string text;
  std::getline(std::ifstream(path), text, '\0');
  for (std::size_t at; (at = text.find("</CellData Scalars=\"labels\">")) != std::string::npos;)
    text.replace(at, 28, "</CellData>");
  const VolumeFile file = read_volume(file_with("cells", text));
  CHECK(file.volume.grid.size == glm::ivec3(2, 3, 1));
  CHECK(file.volume.grid.origin == glm::dvec3(10 + 2.5 * 2, 20 + 1.5, 32));
  CHECK(file.tissues.find_file_value(200));
}

TEST_CASE("vti: what is written comes back, oblique and large") {
  LabelVolume volume;
  volume.grid = {glm::ivec3(130, 121, 90), glm::dvec3(1.5, 2, 0.7), glm::dvec3(-3, 4, 5.25),
                 glm::dmat3(glm::dvec3(0.8, 0.6, 0), glm::dvec3(-0.6, 0.8, 0), glm::dvec3(0, 0, 1))};
  volume.voxels.resize(static_cast<std::size_t>(volume.grid.voxel_count()));
  TissueTable tissues;
  for (Label label : {1, 2}) {
    Tissue tissue;
    tissue.label = label;
    tissue.file_value = label == 1 ? 7 : 300;
    tissues.tissues.push_back(tissue);
  }
  for (std::size_t i = 0; i < volume.voxels.size(); ++i)
    volume.voxels[i] = static_cast<Label>(i * 2654435761u >> 7 & 1 ? i % 3 : 0);
  for (const bool compressed : {true, false}) {
    const Path path = std::filesystem::temp_directory_path() / "limber-written.vti";
    write_volume(volume, path, tissues, {"VTK image", "uint16", compressed});
    const VolumeFile back = read_volume(path);
    CHECK(back.volume.grid == volume.grid);
    CHECK(back.type.compressed == compressed);
    std::int64_t wrong = 0;
    const auto value_of = [](const TissueTable& table, Label label) {
      return label == 0 ? 0 : table.find(label)->file_value;
    };
    for (std::size_t i = 0; i < volume.voxels.size(); ++i)
      wrong += value_of(back.tissues, back.volume.voxels[i]) != value_of(tissues, volume.voxels[i]);
    CHECK(wrong == 0);
    std::filesystem::remove(path);
  }
}

TEST_CASE("vti: damage is told in a line") {
  const std::string array = R"(<DataArray type="UInt16" Name="a" format="appended" offset="0"/>)";
  const auto raw = [&](const std::string& bytes, const std::string& more = "") {
    return problem_of(file_with("damaged", image(array, "<AppendedData encoding=\"raw\">_" + bytes, more)));
  };
  const std::string whole = image(array, "<AppendedData encoding=\"raw\">_" + bytes_of<std::uint32_t>({12}) + kShorts);
  const std::size_t behind = std::string("</VTKFile>").size();
  CHECK(problem_of(file_with("cut", whole.substr(0, whole.size() - behind))).empty());
  CHECK(problem_of(file_with("cut", whole.substr(0, whole.size() - behind - 1))).find("cut off") != std::string::npos);
  CHECK(raw(bytes_of<std::uint32_t>({13}) + kShorts).find("not as long as the header says") != std::string::npos);
  const std::string zlib = R"(compressor="vtkZLibDataCompressor")", a = packed(kShorts);
  const auto length = static_cast<std::uint32_t>(a.size());
  std::string wrong = a;
  wrong[a.size() - 1] ^= 1;  // a bit of the checksum
  CHECK(raw(bytes_of<std::uint32_t>({1, 12, 0, length}) + a, zlib).empty());
  CHECK(raw(bytes_of<std::uint32_t>({1, 12, 0, length}) + wrong, zlib).find("damaged") != std::string::npos);
  CHECK(raw(bytes_of<std::uint32_t>({1, 20, 0, length}) + a, zlib).find("not as long") != std::string::npos);
  CHECK(raw(bytes_of<std::uint32_t>({4000000000u, 12, 0}) + a, zlib).find("damaged") != std::string::npos);
  CHECK(raw("", R"(compressor="vtkLZ4DataCompressor")").find("compressed by") != std::string::npos);
  CHECK(problem_of(file_with("pieces",
                             "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 1 0 1 0 1\"><Piece "
                             "Extent=\"0 0 0 1 0 1\"/><Piece/></ImageData></VTKFile>"))
            .find("several pieces") != std::string::npos);
  CHECK(problem_of(file_with("grid", "<VTKFile type=\"PolyData\"><PolyData/></VTKFile>")).find("ImageData") !=
        std::string::npos);
  CHECK(problem_of(file_with("xml", "<VTKFile type=\"ImageData\"><ImageData></VTKFile>")).find("not valid XML") !=
        std::string::npos);
  CHECK(problem_of(
            file_with("word", image(R"(<DataArray type="UInt8" Name="a" format="ascii">0 1 2 3 0 300</DataArray>)")))
            .find("not a number of its type") != std::string::npos);
}
