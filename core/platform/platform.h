// SPDX-License-Identifier: AGPL-3.0-or-later
// Everything that depends on the operating system is in this folder. Its headers use only standard C++; its sources are
// written for Linux. No source outside of this folder includes a header that only POSIX has, calls such a function, or
// contains a path of one system (tests/layers checks this). The folder includes no other folder of core.
//
// This page lists what Limber would need on Windows and on macOS. "The same" means that the source compiles and works
// as it is.
//
//   open_file         Windows: CreateFile with all three share modes, ReadFile and WriteFile at an offset, LockFileEx,
//                     FlushFileBuffers, SetEndOfFile. There are no nameless files, so nameless() returns no file. The
//                     permissions of a replaced file are its access control list.
//                     macOS: no O_TMPFILE, so nameless() returns no file; F_FULLFSYNC instead of fsync and fdatasync.
//   file_system       Windows: GetFileInformationByHandle (volume and file index), the owner by GetSecurityInfo, errors
//                     by std::system_category, and folders that need no flush. macOS: st_mtimespec instead of st_mtim.
//   child_process     Windows: there is no fork. The two callers (TetGen, tests) must start the program anew and send
//                     it the input. macOS: no pipe2; the limit of memory is not enforced.
//   child_program     Windows: CreateProcess with a list of inherited handles, and a job object instead of a process
//                     group. ask_to_end() needs an event that the worker listens to. Exit codes such as
//                     0xC0000005 take the place of signals. macOS: the processor time by proc_pidinfo.
//   pipe              Windows: overlapped named pipes; an open file is sent by DuplicateHandle and the handle's number.
//                     macOS: no pipe2, no MSG_CMSG_CLOEXEC, no MSG_NOSIGNAL and no F_SETPIPE_SZ.
//   process           Windows: a job object that ends with its last handle instead of the parent's death signal,
//                     SetPriorityClass, SetThreadPriority, GetProcessTimes, GetProcessMemoryInfo. macOS: a kqueue that
//                     watches the parent, task_info instead of /proc/self/statm, peak memory in bytes, no closefrom,
//                     no SCHED_IDLE.
//   sandbox           Windows: an AppContainer, a restricted token and a job object with limits. macOS: sandbox_init
//                     with a profile that denies everything. Without either, only the limits of resources remain.
//   module            Windows: LoadLibraryEx with an absolute path, GetProcAddress, GetModuleFileName; names end in
//                     .dll and programs in .exe; PATH is separated by semicolons; CMakeLists.txt sets the suffix .so.
//                     macOS: _NSGetExecutablePath instead of /proc/self/exe; names end in .so as well.
//   memory            Windows: GlobalMemoryStatusEx and the limit of the job object. macOS: host_statistics64.
//   memory_pages      Windows: VirtualAlloc, which reserves before it commits, so zeros of a large grid must be
//                     committed page by page. macOS: no MADV_HUGEPAGE, and no MAP_NORESERVE, as it never reserves.
//   give_back_pages   Windows: VirtualAlloc with MEM_RESET. macOS: MADV_FREE.
//   large_blocks      Windows, macOS: the same, without effect: only glibc has the settings.
//   host              Windows: GetComputerNameEx, RtlGetVersion, the registry's name of the processor. macOS: sysctl.
//   terminal          Windows: GetConsoleMode; colours and line erasing need ENABLE_VIRTUAL_TERMINAL_PROCESSING.
//                     macOS: the same.
//   local_time        Windows: localtime_s. macOS: the same.
//   desktop           Windows: SHGetKnownFolderPath, GetLogicalDrives, ShellExecute. macOS: ~/Library, /Volumes, open.
//   path              Windows: paths are wide strings. Path::string() must return UTF-8, which needs the program's
//                     manifest to choose the UTF-8 code page. macOS: the same.
//
// Outside this folder:
//   CMakeLists.txt             the suffix of modules, $ORIGIN in paths of libraries, LINKER:--as-needed, libdl
//   render/gl/egl_context      a context without a window: WGL with a hidden window, or CGL; macOS has OpenGL 4.1 only
//   core/cmd/progress.cpp      no SIGTERM reaches a program on Windows; SIGINT (Ctrl+C) does
//   core/project/journal.cpp   links to journals: Windows lets only some users make symbolic links
//   editor/ui/fonts.cpp        the fonts must come with the program, where it looks for them first
//   editor/file_browser        lists "/" as the computer, and hides files whose names begin with a dot
//   vector types               core/skin, core/fem and core/binding use those of GCC and clang: Windows needs clang
//   tests                      start programs by fork and exec, and make calls fail by LD_PRELOAD
#pragma once
