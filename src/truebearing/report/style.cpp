// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/style.hpp"

namespace truebearing {

const std::string& plot_style() {
  static const std::string style = R"(
:root { color-scheme: light dark; --ink: #1d2128; --soft: #5b6470; --grid: #e3e6ea; --paper: #ffffff; --card: #ffffff;
  --s0: #0072b2; --s1: #d55e00; --s2: #00875f; --s3: #b8568f; --s4: #6a51a3; --s5: #9a6b00; --s6: #6f757d; --s7: #8c3b2a;
  --measured: #8a929c; --best: #e4f2ea; }
@media screen and (prefers-color-scheme: dark) {
  :root { --ink: #e8eaed; --soft: #a2abb7; --grid: #30363e; --paper: #121519; --card: #191d23;
    --s0: #56b4e9; --s1: #ff8a3d; --s2: #2fcb9b; --s3: #e59ac6; --s4: #b39dff; --s5: #f0c23b; --s6: #b3b9c1; --s7: #e08a78;
    --measured: #7d8794; --best: #1c3a2c; } }
svg.plot { display: block; width: 100%; height: auto; background: var(--card); font: 13px system-ui, "Segoe UI", Helvetica, Arial, sans-serif; }
svg.plot text { fill: var(--ink); } svg.plot .tick { fill: var(--soft); font-size: 12px; }
.grid { stroke: var(--grid); fill: none; } .frame { stroke: var(--soft); fill: none; }
.line { fill: none; stroke-width: 2; stroke-linejoin: round; stroke-linecap: round; }
.dots { fill: none; stroke-width: 5.5; stroke-linecap: round; stroke-opacity: 0.55; }
.around { fill-opacity: 0.08; stroke-width: 1; stroke-opacity: 0.8; }
.band { stroke: none; fill-opacity: 0.11; } .sight { fill: none; stroke-width: 1; stroke-opacity: 0.35; }
.s0 { stroke: var(--s0); fill: var(--s0); } .s1 { stroke: var(--s1); fill: var(--s1); }
.s2 { stroke: var(--s2); fill: var(--s2); } .s3 { stroke: var(--s3); fill: var(--s3); }
.s4 { stroke: var(--s4); fill: var(--s4); } .s5 { stroke: var(--s5); fill: var(--s5); }
.s6 { stroke: var(--s6); fill: var(--s6); } .s7 { stroke: var(--s7); fill: var(--s7); }
.line.s1 { stroke-dasharray: 8 4; } .line.s2 { stroke-dasharray: 2 4; } .line.s3 { stroke-dasharray: 9 4 2 4; }
.line.s4 { stroke-width: 2.5; } .line.s5 { stroke-dasharray: 12 4; } .line.s6 { stroke-dasharray: 4 3 1 3; }
.line.s7 { stroke-dasharray: 12 3 2 3 2 3; }
.truth, .bound, .ideal, .own { stroke: var(--ink); fill: var(--ink); }
.measured { stroke: var(--measured); fill: var(--measured); }
.line.truth { stroke-width: 2.5; stroke-opacity: 0.75; } .line.bound { stroke-width: 1.5; stroke-dasharray: 6 4; }
.other { stroke: var(--soft); fill: var(--soft); } .line.other { stroke-width: 1; stroke-opacity: 0.45; }
.band.seen { fill: var(--measured); fill-opacity: 0.32; }
.event { stroke: var(--ink); fill: var(--ink); } .line.event { stroke-width: 1; stroke-dasharray: 2 3; } .dots.event { stroke-width: 8; stroke-opacity: 0.8; }
.cells { stroke: none; fill: var(--ink); } .level1 { fill-opacity: 0.42; } .level2 { fill-opacity: 0.3; } .level3 { fill-opacity: 0.2; }
.level4 { fill-opacity: 0.12; } .level5 { fill-opacity: 0.06; }
.line.ideal { stroke-width: 1; stroke-opacity: 0.7; } .line.own { stroke-width: 3; stroke-opacity: 0.5; }
.line { fill: none; } .dots { fill: none; } .sight { fill: none; } .band { stroke: none; }
)";
  return style;
}

const std::string& page_style() {
  static const std::string style = plot_style() + R"(
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 16px/1.5 system-ui, "Segoe UI", Helvetica, Arial, sans-serif; }
main { max-width: 1240px; margin: 0 auto; padding: 20px 16px 48px; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: 0.4em 0 0.2em; } h2 { font-size: 1.25rem; margin: 1.8em 0 0.5em; }
h3 { font-size: 1rem; margin: 1.2em 0 0.3em; } h1, h2, h3, p, figcaption, footer { overflow-wrap: anywhere; }
.question { color: var(--soft); margin: 0.3em 0; } .answer { font-size: 1.2rem; margin: 0.3em 0 1em; max-width: 60em; }
.where, .note { color: var(--soft); font-size: 0.9rem; margin: 0.3em 0; }
.wide { overflow-x: auto; } .long { max-height: 420px; overflow: auto; } table { border-collapse: collapse; font-size: 0.9rem; font-variant-numeric: tabular-nums; }
th, td { padding: 4px 10px; text-align: right; border-bottom: 1px solid var(--grid); white-space: nowrap; }
th:first-child, td:first-child { text-align: left; } thead th { color: var(--soft); font-weight: 600; vertical-align: bottom; }
tbody th { font-weight: 600; } .se { color: var(--soft); } .best { background: var(--best); font-weight: 700; }
td.words { white-space: normal; min-width: 9em; } td.prose { white-space: normal; text-align: left; min-width: 46em; } .wide + .plots, .wide + .wide { margin-top: 14px; }
.tag { font-size: 0.75rem; color: var(--soft); border: 1px solid var(--soft); border-radius: 4px; padding: 0 4px; margin-left: 6px; }
.swatch { display: inline-block; width: 28px; height: 10px; margin-right: 8px; }
.plots { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 480px), 1fr)); gap: 20px; align-items: start; }
figure { margin: 0; padding: 12px; background: var(--card); border: 1px solid var(--grid); border-radius: 8px; min-width: 0; }
figcaption { margin: 0 0 6px; } figcaption strong { display: block; } figcaption span { color: var(--soft); font-size: 0.9rem; }
details { margin-top: 6px; } summary { cursor: pointer; color: var(--soft); font-size: 0.9rem; }
details .wide { max-height: 320px; overflow: auto; } details table { font-size: 0.8rem; }
summary:focus-visible { outline: 2px solid var(--s0); outline-offset: 2px; }
.up { color: var(--s1); font-weight: 600; } .down { color: var(--s2); font-weight: 600; }
.player { display: flex; gap: 10px; align-items: center; } .player input { flex: 1; min-width: 0; accent-color: var(--s0); }
.player output { color: var(--soft); font-size: 0.9rem; min-width: 4em; text-align: right; }
.player button { font: inherit; font-size: 0.9rem; color: var(--ink); background: var(--card); border: 1px solid var(--soft); border-radius: 6px; padding: 2px 12px; cursor: pointer; }
footer { margin-top: 3em; color: var(--soft); font-size: 0.85rem; }
@media (max-width: 520px) { body { font-size: 15px; } td.words { white-space: nowrap; } figure { padding: 8px 4px; border-radius: 0; } main { padding: 12px 8px 32px; }
  svg.plot { font-size: 14px; min-width: 520px; } svg.plot .tick { font-size: 14px; } figure { overflow-x: auto; } }
@media print { :root, body { font-size: 10pt; } main { max-width: none; padding: 0; } figure, table { break-inside: avoid; }
  .plots { grid-template-columns: 1fr 1fr; gap: 8px; } figure { border: none; padding: 4px; } details, .player { display: none; }
  .wide { overflow: visible; max-height: none; } table { font-size: 7.5pt; } th, td { padding: 2px 5px; } thead th { white-space: normal; } .tag { font-size: 6pt; } }
)";
  return style;
}

}  // namespace truebearing
