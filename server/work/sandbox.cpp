#include "server/work/sandbox.hpp"

#include <fcntl.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <memory>
#include <string>
#include <string_view>

#include "core/base/error.hpp"

namespace unwrapd::server::work {
namespace {

constexpr int kKeptDescriptors = 3;
constexpr std::string_view kFirstToGo = "1000";  // the most that proc(5) allows

/// The calls that malloc, threads, signals, clocks and open descriptors need.
constexpr std::array kAllowed = {SCMP_SYS(read),
                                 SCMP_SYS(write),
                                 SCMP_SYS(readv),
                                 SCMP_SYS(writev),
                                 SCMP_SYS(recvfrom),
                                 SCMP_SYS(sendto),
                                 SCMP_SYS(recvmsg),
                                 SCMP_SYS(sendmsg),
                                 SCMP_SYS(close),
                                 SCMP_SYS(fstat),
                                 SCMP_SYS(lseek),
                                 SCMP_SYS(poll),
                                 SCMP_SYS(ppoll),
                                 SCMP_SYS(munmap),
                                 SCMP_SYS(mremap),
                                 SCMP_SYS(madvise),
                                 SCMP_SYS(brk),
                                 SCMP_SYS(futex),
                                 SCMP_SYS(rseq),
                                 SCMP_SYS(set_robust_list),
                                 SCMP_SYS(rt_sigaction),
                                 SCMP_SYS(rt_sigprocmask),
                                 SCMP_SYS(rt_sigreturn),
                                 SCMP_SYS(rt_sigtimedwait),
                                 SCMP_SYS(sigaltstack),
                                 SCMP_SYS(sched_yield),
                                 SCMP_SYS(getpid),
                                 SCMP_SYS(gettid),
                                 SCMP_SYS(exit),
                                 SCMP_SYS(exit_group),
                                 SCMP_SYS(clock_gettime),
                                 SCMP_SYS(clock_nanosleep),
                                 SCMP_SYS(nanosleep),
                                 SCMP_SYS(gettimeofday),
                                 SCMP_SYS(getrandom),
                                 SCMP_SYS(getrusage),
                                 SCMP_SYS(sysinfo),
                                 SCMP_SYS(restart_syscall),
                                 SCMP_SYS(set_tid_address)};

/// Calls that the C library tries and does not need.
constexpr std::array kRefused = {SCMP_SYS(openat), SCMP_SYS(open),     SCMP_SYS(newfstatat),
                                 SCMP_SYS(access), SCMP_SYS(ioctl),    SCMP_SYS(readlink),
                                 SCMP_SYS(prctl),  SCMP_SYS(prlimit64)};

[[noreturn]] void cannot(const char* what) {
  throw Error(ErrorCode::internal, std::string("A worker process cannot ") + what +
                                       "; run with --isolate=off, or on a kernel with seccomp.");
}

/// more: by which the hard limit is above it.
void limit(__rlimit_resource resource, std::int64_t value, std::int64_t more = 0) {
  const rlimit bound{static_cast<rlim_t>(value), static_cast<rlim_t>(value + more)};
  if (::setrlimit(resource, &bound) != 0) cannot("limit its resources");
}

using Filter = std::unique_ptr<void, decltype(&seccomp_release)>;

void allow(const Filter& filter, int call) {
  if (seccomp_rule_add(filter.get(), SCMP_ACT_ALLOW, call, 0) != 0)
    cannot("filter its system calls");
}

/// Allows a call only with none of these flags in an argument.
void allow_without(const Filter& filter, int call, unsigned argument, std::uint64_t flags) {
  const scmp_arg_cmp none{argument, SCMP_CMP_MASKED_EQ, flags, 0};
  if (seccomp_rule_add_array(filter.get(), SCMP_ACT_ALLOW, call, 1, &none) != 0)
    cannot("filter its system calls");
}

/// Allows a call only for this process, which the first argument names.
void allow_of_process(const Filter& filter, int call, pid_t process) {
  const scmp_arg_cmp same{0, SCMP_CMP_EQ, static_cast<scmp_datum_t>(process), 0};
  if (seccomp_rule_add_array(filter.get(), SCMP_ACT_ALLOW, call, 1, &same) != 0)
    cannot("filter its system calls");
}

void refuse(const Filter& filter, int call, std::uint16_t error) {
  if (seccomp_rule_add(filter.get(), SCMP_ACT_ERRNO(error), call, 0) != 0)
    cannot("filter its system calls");
}

void filter_calls() {
  const Filter filter(seccomp_init(SCMP_ACT_KILL_PROCESS), &seccomp_release);
  if (!filter || seccomp_attr_set(filter.get(), SCMP_FLTATR_CTL_TSYNC, 1) != 0)
    cannot("filter its system calls");
  for (const int call : kAllowed) allow(filter, call);
  for (const int call : kRefused) refuse(filter, call, EACCES);
  allow_of_process(filter, SCMP_SYS(tgkill), ::getpid());  // abort() sends itself a signal
  allow_of_process(filter, SCMP_SYS(sched_getaffinity), ::getpid());
  allow_of_process(filter, SCMP_SYS(sched_getaffinity), 0);  // the caller
  allow_without(filter, SCMP_SYS(mmap), 2, PROT_EXEC);
  allow_without(filter, SCMP_SYS(mprotect), 2, PROT_EXEC);
  if (seccomp_load(filter.get()) != 0) cannot("filter its system calls");
}

}  // namespace

void enter_sandbox(const SandboxLimits& limits) {
  if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) cannot("die with its server");
  if (::close_range(kKeptDescriptors, ~0U, 0) != 0) cannot("close inherited files");
  limit(RLIMIT_AS, limits.memory_bytes);
  limit(RLIMIT_CPU, limits.processor_seconds, 1);  // SIGXCPU tells why, which SIGKILL does not
  limit(RLIMIT_NOFILE, kKeptDescriptors);
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_CORE, 0);
  if (::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) cannot("give up privileges");
  filter_calls();
}

void be_first_to_go() {
  const int file = ::open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (file < 0) return;
  static_cast<void>(!::write(file, kFirstToGo.data(), kFirstToGo.size()));
  ::close(file);
}

}  // namespace unwrapd::server::work
