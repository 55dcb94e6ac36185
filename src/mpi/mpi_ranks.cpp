// SPDX-License-Identifier: Apache-2.0
// Ranks over MPI, by its C interface.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <mpi.h>
#include <thread>

#include "truebearing/core/error.hpp"
#include "mpi/mpi_module.hpp"

namespace truebearing {
namespace {

constexpr int kNumber = 1, kPart = 2;
constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;  // MPI counts in int

// For all ranks, or for rank 0. What takes long (a training) shall not cost the others' processors meanwhile, as MPI's
// own waiting does: between looks it sleeps for a fiftieth of the time that it has waited.
void wait_for(MPI_Request request) {
  using Clock = std::chrono::steady_clock;
  constexpr Clock::duration kLongestSleep = std::chrono::milliseconds(20);
  const Clock::time_point begin = Clock::now();
  for (int is_done = 0;;) {
    MPI_Test(&request, &is_done, MPI_STATUS_IGNORE);
    if (is_done != 0) return;
    std::this_thread::sleep_for(std::min((Clock::now() - begin) / 50, kLongestSleep));
  }
}

int part_of(std::size_t left) {
  return static_cast<int>(std::min(left, kMostAtOnce));
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

  void send(std::size_t number, std::string_view bytes) override {
    const unsigned long head[2] = {number, bytes.size()};
    MPI_Send(head, 2, MPI_UNSIGNED_LONG, 0, kNumber, MPI_COMM_WORLD);
    while (!bytes.empty()) {
      const int part = part_of(bytes.size());
      MPI_Send(bytes.data(), part, MPI_BYTE, 0, kPart, MPI_COMM_WORLD);
      bytes.remove_prefix(static_cast<std::size_t>(part));
    }
  }

  std::optional<std::pair<std::size_t, std::string>> receive() override {
    int has_come = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, kNumber, MPI_COMM_WORLD, &has_come, &status);
    if (has_come == 0) return std::nullopt;
    unsigned long head[2] = {0, 0};
    const int source = status.MPI_SOURCE;
    MPI_Recv(head, 2, MPI_UNSIGNED_LONG, source, kNumber, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    std::pair<std::size_t, std::string> come{head[0], std::string(head[1], '\0')};
    for (std::size_t done = 0; done < come.second.size();) {
      const int part = part_of(come.second.size() - done);
      MPI_Recv(come.second.data() + done, part, MPI_BYTE, source, kPart, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
      done += static_cast<std::size_t>(part);
    }
    return come;
  }

  std::vector<std::string> gather_all(std::string_view bytes) override {
    std::vector<unsigned long> lengths(size());
    const unsigned long own = bytes.size();
    MPI_Request request;
    MPI_Iallgather(&own, 1, MPI_UNSIGNED_LONG, lengths.data(), 1, MPI_UNSIGNED_LONG, MPI_COMM_WORLD, &request);
    wait_for(request);
    std::vector<std::string> all(size());
    for (int root = 0; root < size_; ++root) {
      std::string& text = all[static_cast<std::size_t>(root)];
      if (root == rank_) text = bytes;
      text.resize(lengths[static_cast<std::size_t>(root)]);
      for (std::size_t done = 0; done < text.size();) {
        const int part = part_of(text.size() - done);
        MPI_Ibcast(text.data() + done, part, MPI_BYTE, root, MPI_COMM_WORLD, &request);
        wait_for(request);
        done += static_cast<std::size_t>(part);
      }
    }
    return all;
  }

  void leave() override { MPI_Finalize(); }

  [[noreturn]] void abort() override {
    MPI_Abort(MPI_COMM_WORLD, 1);
    std::_Exit(1);
  }

 private:
  int rank_ = 0, size_ = 1;
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
