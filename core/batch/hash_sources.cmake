# SPDX-License-Identifier: AGPL-3.0-or-later
# Writes a source file with the hash that core/batch/computing_sources.h gives: cmake -DFOLDER=core -DOUT=FILE.cpp "-DFILES=a.h,b.cpp" -P hash_sources.cmake
string(REPLACE "," ";" files "${FILES}")
list(SORT files)
set(all "")
foreach(file IN LISTS files)
  file(SHA256 "${FOLDER}/${file}" hash)
  string(APPEND all "${file} ${hash}\n")
endforeach()
string(SHA256 hash "${all}")
file(WRITE "${OUT}" "#include \"core/batch/computing_sources.h\"\n\nconst char* limber::computing_sources() { return \"${hash}\"; }\n")
