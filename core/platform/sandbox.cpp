// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/platform/sandbox.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "core/platform/process.h"

namespace limber {

namespace {

#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t kArchitecture = 0;  // no system call filter is written for this processor architecture
#endif

// Upper limit on memory, bytes: half of a process's address space, so that sums with this limit cannot overflow.
constexpr std::size_t kMostMemory = std::size_t{1} << 46;

// Sets a resource limit of this process. Never raises a limit that is in force.
void limit(__rlimit_resource what, rlim_t soft, rlim_t hard) {
  rlimit now{};
  if (::getrlimit(what, &now) != 0) return;
  const rlimit wanted{std::min({soft, hard, now.rlim_max}), std::min(hard, now.rlim_max)};
  ::setrlimit(what, &wanted);
}

#ifdef LIMBER_SANITIZED
// Memory is not limited, since AddressSanitizer needs several times the memory that the program requests.
constexpr bool kLimitsMemory = false;
#else
constexpr bool kLimitsMemory = true;
#endif

void limit_resources(const SandboxSettings& settings, std::size_t mapped) {
  const rlim_t seconds = static_cast<rlim_t>(std::clamp(std::ceil(settings.processor_seconds), 1.0, 1e9));
  const std::size_t most = std::max(settings.most_memory, settings.memory_bytes);
  if (kLimitsMemory) limit(RLIMIT_AS, mapped + settings.memory_bytes, mapped + std::min(most, kMostMemory));
  limit(RLIMIT_CPU, seconds, seconds + 1);
  limit(RLIMIT_CORE, 0, 0);
  limit(RLIMIT_FSIZE, 0, 0);
  limit(RLIMIT_NPROC, 0, 0);
  // Upper limit on the number of open files. The process needs two pipe ends and two files of a volume.
  constexpr rlim_t kOpenFiles = 16;
  limit(RLIMIT_NOFILE, kOpenFiles, kOpenFiles);
}

// The kernel's structure for the rules of Landlock, its access control. It is declared here because linux/landlock.h
// may be older on the build machine than the kernel that runs the program.
struct LandlockRules {
  std::uint64_t files, network, scopes;
};
constexpr int kLandlockVersion = 1;  // flag by which the system call returns Landlock's version

std::uint64_t first_bits(int count) { return (std::uint64_t{1} << count) - 1; }

// Returns all rights that a version of Landlock controls. Since no rule grants any of them, Landlock refuses them all.
LandlockRules every_right(int version) {
  const int files = version >= 5 ? 16 : version >= 3 ? 15 : version == 2 ? 14 : 13;
  return {first_bits(files), version >= 4 ? first_bits(2) : 0, version >= 6 ? first_bits(2) : 0};
}

int enter_landlock() {
#ifdef SYS_landlock_create_ruleset
  const long version = ::syscall(SYS_landlock_create_ruleset, nullptr, 0, kLandlockVersion);
  if (version < 1) return 0;
  const LandlockRules rules = every_right(static_cast<int>(version));
  const long ruleset = ::syscall(SYS_landlock_create_ruleset, &rules, sizeof rules, 0);
  if (ruleset < 0) return 0;
  const bool stands = ::syscall(SYS_landlock_restrict_self, ruleset, 0) == 0;
  ::close(static_cast<int>(ruleset));
  return stands ? static_cast<int>(version) : 0;
#else
  return 0;
#endif
}

// Builds a program for the kernel's system call filter (seccomp). The program lists the system calls that are allowed;
// some are allowed only with certain arguments.
class Filter {
 public:
  Filter() {
    load(offsetof(seccomp_data, arch));
    jump(BPF_JEQ, kArchitecture, 1, 0);
    give(SECCOMP_RET_KILL_PROCESS);
    load(offsetof(seccomp_data, nr));
  }
  void allow(long call) {
    jump(BPF_JEQ, static_cast<std::uint32_t>(call), 0, 1);
    give(SECCOMP_RET_ALLOW);
  }
  // Allows the system call when the lower 32 bits of its argument number `argument` equal `value`.
  void allow_if_equal(long call, int argument, std::uint32_t value) { allow_if(call, argument, BPF_JEQ, value, true); }
  // Allows the system call when the lower 32 bits of its argument number `argument` have none of these bits set.
  void allow_without(long call, int argument, std::uint32_t bits) { allow_if(call, argument, BPF_JSET, bits, false); }

  bool enter() {
    give(kRefused);
    const sock_fprog program{static_cast<unsigned short>(code_.size()), code_.data()};
    return kArchitecture != 0 && ::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, 0, &program) == 0;
  }

 private:
  static constexpr std::uint32_t kRefused = SECCOMP_RET_ERRNO | EPERM;

  void load(std::size_t offset) {
    code_.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)));
  }
  void jump(int test, std::uint32_t value, int if_true, int if_false) {
    code_.push_back(BPF_JUMP(static_cast<std::uint16_t>(BPF_JMP | test | BPF_K), value,
                             static_cast<std::uint8_t>(if_true), static_cast<std::uint8_t>(if_false)));
  }
  void give(std::uint32_t answer) { code_.push_back(BPF_STMT(BPF_RET | BPF_K, answer)); }
  void allow_if(long call, int argument, int test, std::uint32_t value, bool wanted) {
    jump(BPF_JEQ, static_cast<std::uint32_t>(call), 0, 4);
    load(offsetof(seccomp_data, args) +
         8 * static_cast<std::size_t>(argument));  // the lower 32 bits of the little-endian argument
    jump(test, value, wanted ? 0 : 1, wanted ? 1 : 0);
    give(SECCOMP_RET_ALLOW);
    give(kRefused);
  }

  std::vector<sock_filter> code_;
};

bool enter_seccomp() {
  Filter filter;
  for (const long call :
       {SYS_read,          SYS_write,      SYS_writev,       SYS_pread64,        SYS_recvmsg,      SYS_lseek,
        SYS_close,         SYS_munmap,     SYS_mremap,       SYS_madvise,        SYS_brk,          SYS_futex,
        SYS_exit,          SYS_exit_group, SYS_rt_sigreturn, SYS_rt_sigprocmask, SYS_rt_sigaction, SYS_restart_syscall,
        SYS_clock_gettime, SYS_getrandom,  SYS_getpid,       SYS_gettid,         SYS_sched_yield})
    filter.allow(call);
#ifdef LIMBER_SANITIZED
  filter.allow(SYS_sigaltstack);  // AddressSanitizer asks for the stack's position whenever an exception is thrown
#endif
  filter.allow_without(SYS_mmap, 2, PROT_EXEC);
  filter.allow_without(SYS_mprotect, 2, PROT_EXEC);
  filter.allow_if_equal(SYS_prlimit64, 0, 0);  // process 0: only the limits of this process
  filter.allow_if_equal(SYS_tgkill, 0, static_cast<std::uint32_t>(::getpid()));  // abort() sends a signal to itself
  return filter.enter();
}

}  // namespace

Sandbox enter_sandbox(const SandboxSettings& settings) {
  Sandbox sandbox{{.own_process = true}, mapped_memory()};
  ::prctl(PR_SET_DUMPABLE, 0, 0, 0, 0);
  limit_resources(settings, sandbox.mapped_bytes);
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return sandbox;
  if (settings.files) sandbox.protection.landlock = enter_landlock();
  if (settings.system_calls) sandbox.protection.system_calls = enter_seccomp();
  return sandbox;
}

void allow_memory(const Sandbox& sandbox, std::size_t bytes) {
  if (!kLimitsMemory) return;
  rlimit now{};
  if (::getrlimit(RLIMIT_AS, &now) != 0) return;
  now.rlim_cur = std::min<rlim_t>(now.rlim_max, sandbox.mapped_bytes + std::min(bytes, kMostMemory));
  ::setrlimit(RLIMIT_AS, &now);
}

}  // namespace limber
