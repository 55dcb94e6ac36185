// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/player.hpp"

namespace truebearing {

// Marks carry the times of their points (svg.cpp): of a line as many as it has corners. What is later than the slider is
// left out of its path.
const std::string& player_script() {
  static const std::string script = R"(
"use strict";
for (const svg of document.querySelectorAll("svg.plot")) {
  const marks = Array.from(svg.querySelectorAll("[data-times]"), (element) => {
    const path = element.getAttribute("d");
    const pieces = !path ? [] : element.classList.contains("line") ? path.match(/[ML ]?-?[0-9.]+ -?[0-9.]+(h0)?/g) : path.split(/(?=M)/);
    return { element, pieces, times: element.dataset.times.split(" ").map(Number) };
  });
  if (marks.length === 0) continue;
  const all = marks.flatMap((mark) => mark.times), first = Math.min(...all), last = Math.max(...all);
  const box = document.createElement("div"), button = document.createElement("button");
  const slider = document.createElement("input"), text = document.createElement("output");
  box.className = "player";
  button.type = "button";
  button.textContent = "Play";
  Object.assign(slider, { type: "range", min: first, max: last, step: "any", value: last });
  slider.setAttribute("aria-label", "time in seconds");
  const show = (time) => {
    text.textContent = time.toFixed(last - first > 100 ? 0 : 1) + " s";
    for (const mark of marks) {
      const there = mark.times.filter((t) => !(t > time)).length;
      if (mark.pieces.length === 0) mark.element.setAttribute("visibility", there ? "visible" : "hidden");
      else mark.element.setAttribute("d", mark.pieces.slice(0, there).join("") || "M-9 -9");
    }
  };
  let playing = 0;
  const stop = () => { cancelAnimationFrame(playing); playing = 0; button.textContent = "Play"; };
  const seconds = 10;
  button.addEventListener("click", () => {
    if (playing) { stop(); return; }
    button.textContent = "Stop";
    const from = Number(slider.value) >= last ? first : Number(slider.value), begin = performance.now();
    const step = (now) => {
      const time = Math.min(last, from + (last - first) * (now - begin) / (1000 * seconds));
      slider.value = time;
      show(time);
      if (time >= last) stop(); else playing = requestAnimationFrame(step);
    };
    playing = requestAnimationFrame(step);
  });
  slider.addEventListener("input", () => { stop(); show(Number(slider.value)); });
  window.addEventListener("beforeprint", () => { stop(); slider.value = last; show(last); });
  box.append(button, slider, text);
  svg.after(box);
  show(last);
}
)";
  return script;
}

}  // namespace truebearing
