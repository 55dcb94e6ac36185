// SPDX-License-Identifier: Apache-2.0
// LimitedChild: work on data that nobody vouches for, by code that is not ours, in a process of its own. Whatever
// becomes of it there - a crash, memory or time without end - this process has bytes or an error. What the work gives
// back goes through a socket.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <sys/types.h>

namespace truebearing {

/// Bytes between the two processes, in order. False where the other end is gone.
class Channel {
 public:
  explicit Channel(int socket) : socket_(socket) {}
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;
  ~Channel();

  bool send(std::span<const std::byte> bytes);
  bool receive(std::span<std::byte> bytes);
  void hang_up();

 private:
  int socket_;
};

class LimitedChild {
 public:
  /// Forks, and runs `work` in the child with a limit on memory (beyond what this process takes) and processor time,
  /// without a core dump and with nowhere to print to. The child ends with it. Throws std::system_error where there can
  /// be no child.
  explicit LimitedChild(const std::function<void(Channel&)>& work);
  LimitedChild(const LimitedChild&) = delete;
  LimitedChild& operator=(const LimitedChild&) = delete;
  /// Ends the child if it is still at work.
  ~LimitedChild();

  Channel& channel() { return *channel_; }
  /// Waits until it has ended, and says why it did: "ran into a fault: Segmentation fault".
  std::string end();

 private:
  std::unique_ptr<Channel> channel_;
  pid_t process_ = -1;
};

/// From now on this process opens no more files: for work that has all it needs.
void open_no_more_files();

}  // namespace truebearing
