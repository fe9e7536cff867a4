# Writes the source that holds kProgramCommit. A build runs it each time; the file changes only with the commit.
#   cmake -DSOURCE=FOLDER -DOUT=FILE -P program_commit.cmake
find_package(Git QUIET)
set(commit "")
if(GIT_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} log -1 --format=%cs OUTPUT_VARIABLE date ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  # As many digits in every clone: Git's own number grows with the objects that a clone has.
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} describe --always --abbrev=12 --exclude=* --dirty=\ with\ changes OUTPUT_VARIABLE name ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  if(date AND name)
    set(commit "${name} of ${date}")
  endif()
endif()
file(CONFIGURE OUTPUT ${OUT} CONTENT [[
#include "core/cmd/program_commit.h"
const char* const limber::cmd::kProgramCommit = "@commit@";
]] @ONLY)
