// SPDX-License-Identifier: Apache-2.0
#include "app/track_output.hpp"

#include <algorithm>

namespace truebearing {
namespace {

const StateSpace* widest(const TrackerSet& trackers) {
  int widest = 0;
  for (int i = 1; i < trackers.size(); ++i)
    if (trackers.space(i).size() > trackers.space(widest).size()) widest = i;
  return &trackers.space(widest);
}

// What an innovation has at most.
int longest(int measured, const std::vector<Source>& sources) {
  std::size_t most = sources.empty() ? static_cast<std::size_t>(std::max(measured, 1)) : 1;
  for (const Source& source : sources) most = std::max(most, source.components.size());
  return static_cast<int>(most);
}

std::vector<std::string> names_of(const std::vector<Source>& sources) {
  std::vector<std::string> names;
  for (const Source& source : sources) names.push_back(source.name);
  return names;
}

}  // namespace

RecordOutput::RecordOutput(const std::string& path, const TrackerSet& trackers, int measured,
                           const std::vector<Source>& sources, bool late)
    : output_(path),
      space_(widest(trackers)),
      writer_(*space_, StepLogWriter::Columns{longest(measured, sources), names_of(sources), late}) {}

void RecordOutput::add(const std::string& name, const StepRecord& record, bool revised) {
  if (record.space == space_) writer_.add(name, record, revised);
  if (!waits_) output_.write(writer_.take());
}

void RecordOutput::finish() {
  if (waits_) writer_.sort_by_time();
  output_.write(writer_.take());
  output_.finish();
}

EventOutput::EventOutput(const std::string& path) : output_(path), csv_({"tracker", "time_s", "event", "value"}) {}

void EventOutput::add(const std::string& tracker, const TrackEvent& event) {
  csv_.text(tracker);
  csv_.number(event.time_s);
  csv_.text(to_string(event.kind));
  csv_.number(event.value);
  csv_.end_row();
}

void EventOutput::flush() {
  output_.write(csv_.take());
  output_.flush();
}

void EventOutput::finish() {
  output_.write(csv_.take());
  output_.finish();
}

}  // namespace truebearing
