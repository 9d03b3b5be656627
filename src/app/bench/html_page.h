// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What the report's page looks like and how its sliders move. Everything is inline: a report is one file.
#pragma once

#include <string_view>

namespace isophote::bench {

inline constexpr std::string_view kStyle = R"css(
:root { color-scheme: light dark; --paper: #fbfaf8; --ink: #1d1f23; --soft: #6b6f76; --line: #dedbd4; --card: #ffffff;
  --accent: #c2571a; --tint-paper: #eef1f6; --tint-here: #fdf1e7; --tint-yardstick: #eaf4ee; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #16181c; --ink: #e6e4df; --soft: #9a9ea6; --line: #33373e; --card: #1e2126; --accent: #f0934f;
    --tint-paper: #232a36; --tint-here: #352a21; --tint-yardstick: #202e27; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 16px/1.55 system-ui, sans-serif; }
header, main { max-width: 1320px; margin: 0 auto; padding: 0 24px; }
header { padding-top: 40px; }
h1 { margin: 0; font-size: 30px; letter-spacing: -0.01em; }
h1 span { color: var(--accent); }
h2 { margin: 56px 0 4px; font-size: 24px; border-top: 2px solid var(--ink); padding-top: 14px; }
h3 { margin: 36px 0 6px; font-size: 17px; }
p { margin: 4px 0 12px; max-width: 76ch; }
.soft { color: var(--soft); font-size: 14px; }
code { font: 13px/1.5 ui-monospace, monospace; overflow-wrap: anywhere; }
nav { display: flex; flex-wrap: wrap; gap: 8px; margin: 16px 0 0; }
nav a, .tabs button { color: var(--ink); background: var(--card); border: 1px solid var(--line); border-radius: 16px;
  padding: 3px 14px; font: inherit; font-size: 14px; text-decoration: none; cursor: pointer; }
nav a:hover, .tabs button:hover { border-color: var(--accent); }
.tabs button[aria-selected=true] { background: var(--ink); color: var(--paper); border-color: var(--ink); }
.tabs { display: flex; flex-wrap: wrap; gap: 6px; margin: 8px 0; }
.notes { border-left: 3px solid var(--accent); padding: 2px 0 2px 16px; margin: 16px 0; list-style: none; font-size: 14px; }
.wide { overflow-x: auto; background: var(--card); border: 1px solid var(--line); border-radius: 8px; }
table { border-collapse: collapse; font-size: 13.5px; font-variant-numeric: tabular-nums; width: 100%; }
th, td { padding: 6px 8px; text-align: right; white-space: nowrap; border-bottom: 1px solid var(--line); }
tr:last-child td { border-bottom: 0; }
th { font-weight: 600; vertical-align: bottom; white-space: normal; }
th i { display: block; font-weight: 400; color: var(--soft); }
.text { text-align: left; }
td.text { white-space: normal; min-width: 104px; max-width: 230px; }
.paper { background: var(--tint-paper); } .here { background: var(--tint-here); } .yardstick { background: var(--tint-yardstick); }
.key span { display: inline-block; padding: 1px 8px; border-radius: 4px; margin-right: 6px; color: var(--ink); }
td small { color: var(--soft); }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 460px), 1fr)); gap: 20px; }
.plot { margin: 0; background: var(--card); border: 1px solid var(--line); border-radius: 8px; padding: 12px 14px; min-width: 0; }
.plot svg { width: 100%; height: auto; display: block; margin-top: 6px; }
.plot h3 { margin: 0; }
figure.compare { margin: 0 0 28px; }
.stage { position: relative; overflow: hidden; border-radius: 8px; background: #000; --cut: 50%; user-select: none; }
.stage img { position: absolute; inset: 0; width: 100%; height: 100%; display: block; }
.stage img[hidden] { display: none; }
.stage .above { clip-path: inset(0 calc(100% - var(--cut)) 0 0); }
.stage .bar { position: absolute; top: 0; bottom: 0; left: var(--cut); width: 2px; margin-left: -1px; background: #fff;
  box-shadow: 0 0 4px rgba(0,0,0,.6); pointer-events: none; }
.stage .bar::after { content: "\2194"; position: absolute; top: 50%; left: 50%; width: 34px; height: 34px; margin: -17px;
  border-radius: 50%; background: #fff; color: #222; text-align: center; line-height: 34px; font-size: 18px; }
.stage b { position: absolute; bottom: 10px; padding: 2px 10px; border-radius: 4px; background: rgba(0,0,0,.55);
  color: #fff; font-size: 13px; font-weight: 500; pointer-events: none; }
.stage b.left { left: 10px; } .stage b.right { right: 10px; }
.stage input { position: absolute; inset: 0; width: 100%; height: 100%; margin: 0; opacity: 0; cursor: ew-resize; }
.stage:focus-within { outline: 3px solid var(--accent); outline-offset: 2px; }
.judged { margin-top: 10px; } .judged[hidden] { display: none; }
.zooms { display: grid; grid-template-columns: repeat(4, 1fr); gap: 8px; }
.zooms div { font-size: 12.5px; color: var(--soft); min-width: 0; }
.zooms img { width: 100%; display: block; image-rendering: pixelated; border-radius: 4px; background: #000; }
.measures { font-size: 14px; margin: 6px 0; } .measures b { font-variant-numeric: tabular-nums; margin-right: 14px; }
footer { margin: 60px 0 40px; }
)css";

inline constexpr std::string_view kScript = R"js(
const stages = [...document.querySelectorAll('.stage')];
function cut(stage, percent) {
  stage.style.setProperty('--cut', percent + '%');
  stage.querySelector('input').value = percent;
}
for (const stage of stages)
  stage.querySelector('input').addEventListener('input', event => cut(stage, event.target.value));
function choose(figure, index) {
  for (const part of figure.querySelectorAll('[data-index]'))
    if (part.tagName === 'BUTTON') part.setAttribute('aria-selected', part.dataset.index === index);
    else part.hidden = part.dataset.index !== index;
}
for (const button of document.querySelectorAll('.tabs button'))
  button.addEventListener('click', () => choose(button.closest('figure'), button.dataset.index));
function obey() {
  const wish = new URLSearchParams(location.hash.slice(1));
  const percent = Number(wish.get('cut'));
  if (wish.has('cut') && percent >= 0 && percent <= 100) for (const stage of stages) cut(stage, percent);
  const picture = wish.get('picture');
  if (picture !== null) for (const stage of stages) choose(stage.closest('figure'), picture);
}
addEventListener('hashchange', obey);
obey();
addEventListener('load', () => {
  const images = [...document.images];
  const shown = images.filter(image => image.complete && image.naturalWidth > 0).length;
  document.documentElement.dataset.pictures = shown + ' of ' + images.length;
});
)js";

}  // namespace isophote::bench
