// SPDX-License-Identifier: Apache-2.0
// Ranks over MPI, by its C interface.
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <list>
#include <mpi.h>
#include <thread>
#include <utility>
#include <vector>

#include "truebearing/core/error.hpp"
#include "mpi/mpi_module.hpp"

namespace truebearing {
namespace {

constexpr int kNumber = 1, kPart = 2;
constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;  // MPI counts in int

bool are_through(std::vector<MPI_Request>& requests) {
  int are_done = 0;
  MPI_Testall(static_cast<int>(requests.size()), requests.data(), &are_done, MPI_STATUSES_IGNORE);
  return are_done != 0;
}

// For all ranks, or for rank 0. What takes long (a training) shall not cost the others' processors meanwhile, as MPI's
// own waiting does: between looks it sleeps for a fiftieth of the time that it has waited. What the others have nearly
// done is not worth a sleep: one wakes late from it where other work wants the processor.
void wait_for(std::vector<MPI_Request> requests) {
  using Clock = std::chrono::steady_clock;
  constexpr Clock::duration kAwake = std::chrono::microseconds(300), kLongestSleep = std::chrono::milliseconds(20);
  const Clock::time_point begin = Clock::now();
  while (!are_through(requests)) {
    const Clock::duration waited = Clock::now() - begin;
    if (waited > kAwake) std::this_thread::sleep_for(std::min(waited / 50, kLongestSleep));
  }
}

void for_parts(std::string& bytes, const std::function<void(char* part, int size)>& each) {
  for (std::size_t done = 0, size = 0; done < bytes.size(); done += size) {
    size = std::min(bytes.size() - done, kMostAtOnce);
    each(bytes.data() + done, static_cast<int>(size));
  }
}

// A message that MPI has not sent or received yet.
struct OnTheWay {
  int rank = 0;
  std::array<unsigned long, 2> head{};  // number, size
  std::string bytes;
  std::vector<MPI_Request> requests;
};

bool is_through(OnTheWay& message) {
  return are_through(message.requests);
}

class MpiRanks final : public Ranks {
 public:
  MpiRanks() {
    int given = 0;
    if (MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &given) != MPI_SUCCESS ||
        given < MPI_THREAD_SERIALIZED)
      throw InputError("mpirun", "has an MPI without threads", "one with MPI_THREAD_SERIALIZED");
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
  }

  std::size_t rank() const override { return static_cast<std::size_t>(rank_); }
  std::size_t size() const override { return static_cast<std::size_t>(size_); }

  void send(std::size_t to, std::size_t number, std::string bytes) override {
    forget_sent();
    OnTheWay& sent = sent_.emplace_back();
    sent.rank = static_cast<int>(to);
    sent.bytes = std::move(bytes);
    sent.head = {number, sent.bytes.size()};
    MPI_Isend(sent.head.data(), 2, MPI_UNSIGNED_LONG, sent.rank, kNumber, MPI_COMM_WORLD,
              &sent.requests.emplace_back());
    for_parts(sent.bytes, [&](char* part, int size) {
      MPI_Isend(part, size, MPI_BYTE, sent.rank, kPart, MPI_COMM_WORLD, &sent.requests.emplace_back());
    });
  }

  std::optional<Message> receive() override {
    forget_sent();
    begin_to_receive();
    for (auto it = coming_.begin(); it != coming_.end(); ++it) {
      if (!is_through(*it)) continue;
      Message message{static_cast<std::size_t>(it->rank), it->head[0], std::move(it->bytes)};
      coming_.erase(it);
      return message;
    }
    return std::nullopt;
  }

  std::vector<std::string> gather_all(std::string_view bytes) override {
    std::vector<unsigned long> lengths(size());
    const unsigned long own = bytes.size();
    std::vector<MPI_Request> requests(1);
    MPI_Iallgather(&own, 1, MPI_UNSIGNED_LONG, lengths.data(), 1, MPI_UNSIGNED_LONG, MPI_COMM_WORLD, &requests[0]);
    wait_for(std::exchange(requests, {}));
    std::vector<std::string> all(size());
    for (int root = 0; root < size_; ++root) {
      std::string& text = all[static_cast<std::size_t>(root)];
      if (root == rank_) text = bytes;
      text.resize(lengths[static_cast<std::size_t>(root)]);
      for_parts(text, [&](char* part, int size_of_part) {
        MPI_Ibcast(part, size_of_part, MPI_BYTE, root, MPI_COMM_WORLD, &requests.emplace_back());
      });
    }
    wait_for(std::move(requests));
    return all;
  }

  void leave() override {
    for (OnTheWay& message : sent_)
      MPI_Waitall(static_cast<int>(message.requests.size()), message.requests.data(), MPI_STATUSES_IGNORE);
    MPI_Finalize();
  }

  [[noreturn]] void abort() override {
    MPI_Abort(MPI_COMM_WORLD, 1);
    std::_Exit(1);
  }

 private:
  void forget_sent() { sent_.remove_if(is_through); }

  // Of whatever has come its number and size.
  void begin_to_receive() {
    for (;;) {
      int has_come = 0;
      MPI_Status status;
      MPI_Iprobe(MPI_ANY_SOURCE, kNumber, MPI_COMM_WORLD, &has_come, &status);
      if (has_come == 0) return;
      OnTheWay& message = coming_.emplace_back();
      message.rank = status.MPI_SOURCE;
      MPI_Recv(message.head.data(), 2, MPI_UNSIGNED_LONG, message.rank, kNumber, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
      message.bytes.resize(message.head[1]);
      for_parts(message.bytes, [&](char* part, int size) {
        MPI_Irecv(part, size, MPI_BYTE, message.rank, kPart, MPI_COMM_WORLD, &message.requests.emplace_back());
      });
    }
  }

  int rank_ = 0, size_ = 1;
  std::list<OnTheWay> sent_, coming_;  // where MPI reads and writes, they stay
};

std::unique_ptr<Ranks> join() {
  return std::make_unique<MpiRanks>();
}

}  // namespace
}  // namespace truebearing

extern "C" {
extern const truebearing::MpiModule truebearing_mpi_module;
const truebearing::MpiModule truebearing_mpi_module{truebearing::join};
}
