// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/limited_child.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace truebearing::limited_child_test {
namespace {

using ::testing::HasSubstr;

void send_text(Channel& channel, std::string_view text) {
  channel.send(std::as_bytes(std::span(text)));
}

std::string received(LimitedChild& child, std::size_t size) {
  std::string text(size, '\0');
  EXPECT_TRUE(child.channel().receive(std::as_writable_bytes(std::span(text))));
  return text;
}

bool sends_more(LimitedChild& child) {
  std::array<std::byte, 1> byte{};
  return child.channel().receive(byte);
}

TEST(LimitedChild, SendsWhatItsWorkSays) {
  LimitedChild child([](Channel& channel) {
    send_text(channel, "first");
    send_text(channel, std::string(1'000'000, 'x'));
  });
  EXPECT_EQ(received(child, 5), "first");
  EXPECT_EQ(received(child, 1'000'000), std::string(1'000'000, 'x'));
  EXPECT_FALSE(sends_more(child));
}

TEST(LimitedChild, HearsWhatItIsTold) {
  LimitedChild child([](Channel& channel) {
    std::string told(5, ' ');
    while (channel.receive(std::as_writable_bytes(std::span(told)))) send_text(channel, "not " + told);
  });
  for (const char* told : {"first", "other"}) {
    send_text(child.channel(), told);
    EXPECT_EQ(received(child, 9), std::string("not ") + told);
  }
}

TEST(LimitedChild, FaultEndsTheChildAlone) {
  LimitedChild child([](Channel& channel) {
    send_text(channel, "part");
    std::raise(SIGSEGV);
  });
  EXPECT_EQ(received(child, 4), "part");
  EXPECT_FALSE(sends_more(child));
  EXPECT_THAT(child.end(), HasSubstr("Segmentation fault"));
}

TEST(LimitedChild, ThrownWorkEndsIt) {
  LimitedChild child([](Channel&) { throw std::runtime_error("no"); });
  EXPECT_FALSE(sends_more(child));
  EXPECT_EQ(child.end(), "gave up");
}

TEST(LimitedChild, MemoryIsLimited) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer takes more addresses than any limit";
#endif
  LimitedChild child([](Channel& channel) {
    const std::vector<char> much(std::size_t{2} << 30);
    send_text(channel, std::string_view(much.data(), 1));
  });
  EXPECT_FALSE(sends_more(child));
}

TEST(LimitedChild, SaysNothingItself) {
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  LimitedChild child([](Channel&) {
    std::fputs("out", stdout);
    std::fputs("err", stderr);
    std::fflush(stdout);
  });
  EXPECT_FALSE(sends_more(child));
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

TEST(LimitedChild, OpensNoMoreFilesWhereItSaysSo) {
  LimitedChild child([](Channel& channel) {
    const bool before = std::ifstream("/etc/passwd").good();
    open_no_more_files();
    send_text(channel, before && !std::ifstream("/etc/passwd").good() ? "y" : "n");
  });
  EXPECT_EQ(received(child, 1), "y");
}

TEST(LimitedChild, OneThatIsNotWaitedForIsEnded) {
  LimitedChild endless([](Channel&) {
    for (;;) ::pause();
  });
}

}  // namespace
}  // namespace truebearing::limited_child_test
