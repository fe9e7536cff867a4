// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/mesh/tetgen_files.h"

#include <charconv>

namespace limber {

namespace {

class Text {
 public:
  template <class Value>
  Text& operator<<(Value value) {
    char digits[40];
    text_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
    return *this;
  }
  Text& operator<<(const char* words) {
    text_ += words;
    return *this;
  }
  const std::string& str() const { return text_; }

 private:
  std::string text_;
};

}  // namespace

void write_tetgen_files(const Path& name, const TetMesh& mesh) {
  Path stem = name;
  if (stem.extension() == ".node" || stem.extension() == ".ele") stem.replace_extension();
  Text nodes, tets;
  nodes << mesh.V.rows() << " 3 0 0\n";
  for (Eigen::Index i = 0; i < mesh.V.rows(); ++i) nodes << i << " " << mesh.V(i, 0) << " " << mesh.V(i, 1) << " " << mesh.V(i, 2) << "\n";
  tets << mesh.T.rows() << " 4 1\n";
  for (Eigen::Index i = 0; i < mesh.T.rows(); ++i) {
    tets << i;
    for (const int corner : mesh.T.row(i)) tets << " " << corner;
    tets << " " << int(mesh.region[i]) << "\n";
  }
  write_file_atomically(stem.string() + ".node", nodes.str());
  write_file_atomically(stem.string() + ".ele", tets.str());
}

}  // namespace limber
