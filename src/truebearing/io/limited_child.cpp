// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/limited_child.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <system_error>

namespace truebearing {
namespace {

constexpr rlim_t kMaxBytes = rlim_t{512} << 20;
constexpr rlim_t kMaxProcessor_s = 60;
constexpr unsigned kMaxWait_s = 600;

void limit(decltype(RLIMIT_AS) resource, rlim_t most) {
  rlimit now{};
  if (::getrlimit(resource, &now) != 0) return;
  now.rlim_cur = std::min(now.rlim_cur, most);
  now.rlim_max = std::min(now.rlim_max, most);
  ::setrlimit(resource, &now);
}

// Of addresses, by this process. The address sanitizer takes terabytes of them, and counts the memory itself.
void limit_memory() {
#ifndef __SANITIZE_ADDRESS__
  unsigned long long pages = 0;
  std::FILE* const sizes = std::fopen("/proc/self/statm", "re");
  if (!sizes) return;
  const bool known = std::fscanf(sizes, "%llu", &pages) == 1;
  std::fclose(sizes);
  if (known) limit(RLIMIT_AS, pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + kMaxBytes);
#endif
}

// Handlers of the host would run on the child's faults.
void restore_signals() {
  for (const int signal : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGALRM, SIGXCPU, SIGPIPE, SIGINT, SIGTERM})
    std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
}

void be_silent() {
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nowhere, stream);
}

[[noreturn]] void run_child(const std::function<void(Channel&)>& work, int socket) {
  // Above the streams, one of which it may be where the host has closed them.
  Channel channel(::fcntl(socket, F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
  ::close(socket);
  restore_signals();
  be_silent();
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, kMaxProcessor_s);
  limit_memory();
  ::alarm(kMaxWait_s);
  try {
    work(channel);
  } catch (...) {  // of which the work should have told
    ::_exit(1);
  }
  ::_exit(0);
}

}  // namespace

Channel::~Channel() {
  ::close(socket_);
}

void Channel::hang_up() {
  ::shutdown(socket_, SHUT_RDWR);
}

bool Channel::send(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

bool Channel::receive(std::span<std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::recv(socket_, bytes.data(), bytes.size(), 0);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

LimitedChild::LimitedChild(const std::function<void(Channel&)>& work) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw std::system_error(errno, std::generic_category());
  channel_ = std::make_unique<Channel>(ends[0]);
  process_ = ::fork();
  const int code = errno;
  if (process_ == 0) {
    channel_.reset();
    run_child(work, ends[1]);
  }
  ::close(ends[1]);
  if (process_ < 0) throw std::system_error(code, std::generic_category());
}

LimitedChild::~LimitedChild() {
  if (process_ < 0) return;
  ::kill(process_, SIGKILL);
  end();
}

std::string LimitedChild::end() {
  channel_->hang_up();
  if (process_ < 0) return "gave up";
  int status = 0;
  pid_t ended = -1;
  while ((ended = ::waitpid(process_, &status, 0)) < 0 && errno == EINTR) {
  }
  process_ = -1;
  if (ended < 0 || !WIFSIGNALED(status)) return "gave up";
  switch (const int signal = WTERMSIG(status)) {
    case SIGXCPU:
    case SIGALRM:
      return "took too long";
    case SIGKILL:
      return "was killed";
    default:
      return fmt::format("ran into a fault: {}", ::strsignal(signal));
  }
}

void open_no_more_files() {
  limit(RLIMIT_NOFILE, 0);
}

}  // namespace truebearing
