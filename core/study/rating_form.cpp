// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/rating_form.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
#include "core/study/page_style.h"
#include "core/study/text.h"
#include "core/tissue/tissue_match.h"

namespace limber {

namespace {

using Json = nlohmann::json;

constexpr std::size_t kCodeDigits = 7;

// Returns the code of a picture. It begins with a letter, so that spreadsheets do not read it as a number.
std::string code_of(const CellResult& cell) {
  const Json json = Json::parse(sound_json(cell.cell_json), nullptr, false);
  const std::string key = "picture " + (json.is_object() ? json.value("key", "") : "");
  return "p" + sha256_of_bytes(key.data(), key.size()).substr(0, kCodeDigits);
}

constexpr char kFormStyle[] = R"css(
.form{max-width:1240px;padding:14px 24px 20px}
.form h1{font-size:20px;margin:0}
.form p{margin:6px 0 10px}
.form label{margin-right:18px;white-space:nowrap}
.form input[type=text]{font:inherit;color:inherit;background:var(--paper);border:1px solid var(--line2);
  border-radius:4px;padding:5px 8px}
.form button{font:inherit;font-weight:600;color:inherit;background:var(--panel);border:1px solid var(--line2);
  border-radius:4px;padding:6px 16px;margin-right:8px}
.form button:disabled{opacity:.45}
.shown{display:flex;gap:8px;margin:10px 0}
.shown img{flex:1 1 0;min-width:0;max-height:calc(100vh - 340px);object-fit:contain;background:var(--void);
  border-radius:2px}
.form .tissue-legend{margin:0 0 8px}
.bar{display:flex;flex-wrap:wrap;align-items:center;gap:8px 0}
.bar input[type=text]{flex:1;min-width:200px}
[hidden]{display:none!important}
)css";

constexpr char kFormScript[] = R"js(
"use strict";
const $ = id => document.getElementById(id);
const pictures = JSON.parse($("pictures").textContent);
let rater = "", order = [], at = 0, answers = {};
// Returns the indices of the pictures in random order. The rater's name is the seed of the random numbers, so a rater
// who opens the form again gets the same order and can continue.
function shuffled(name) {
  let state = 2166136261;
  for (const c of name) state = Math.imul(state ^ c.codePointAt(0), 16777619);
  state = state || 1;
  const below = count => {
    state ^= state << 13;
    state ^= state >>> 17;
    state ^= state << 5;
    return Math.floor((state >>> 0) / 4294967296 * count);
  };
  for (let i = 0; i < 20; ++i) below(1);  // skips the first numbers, which hardly differ for similar names
  const list = pictures.map((_, i) => i);
  for (let i = list.length - 1; i > 0; --i) {
    const k = below(i + 1);
    [list[i], list[k]] = [list[k], list[i]];
  }
  return list;
}
const scores = () => [...document.querySelectorAll("input[name=score]")];
const answer_of = i => answers[pictures[i].code] || {};
const place = () => "limber rating " + study + " " + rater;
function keep() {
  try {
    localStorage.setItem(place(), JSON.stringify(answers));
  } catch (error) {
    // In a private window the browser may refuse to store the answers. They then last only as long as the page is open.
  }
}
function show() {
  const picture = pictures[order[at]], answer = answer_of(order[at]);
  $("count").textContent = "Picture " + (at + 1) + " of " + order.length;
  for (const part of ["body", "slice"]) {
    $(part).hidden = !picture[part];
    $(part).src = picture[part] ? "data:image/png;base64," + picture[part] : "";
  }
  for (const button of scores()) button.checked = Number(button.value) === answer.score;
  $("remark").value = answer.remark || "";
  $("back").disabled = at === 0;
  $("next").disabled = at === order.length - 1;
  const done = order.filter(i => answer_of(i).score).length;
  $("done").textContent = done + " of " + order.length + " scored";
}
function answer(change) {
  const code = pictures[order[at]].code;
  answers[code] = Object.assign(answers[code] || {}, change);
  keep();
  show();
}
function go(step) { at = Math.min(Math.max(at + step, 0), order.length - 1); show(); }
function field(text) { return '"' + String(text).replace(/[\r\n]+/g, " ").replace(/"/g, '""') + '"'; }
function save() {
  let text = "study,rater,order,picture,score,remark\r\n";
  order.forEach((i, n) => {
    const one = answer_of(i);
    text += [field(study), field(rater), n + 1, pictures[i].code, one.score || "", field(one.remark || "")].join(",");
    text += "\r\n";
  });
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], {type: "text/csv"}));
  link.download = "scores-" + rater.replace(/[^A-Za-z0-9]+/g, "-") + ".csv";
  link.click();
}
$("begin").onsubmit = event => {
  event.preventDefault();
  rater = $("rater").value.trim();
  if (!rater) return;
  order = shuffled(rater);
  try { answers = JSON.parse(localStorage.getItem(place()) || "{}"); } catch (error) { answers = {}; }
  at = Math.max(0, order.findIndex(i => !answer_of(i).score));
  $("begin").hidden = true;
  $("rate").hidden = false;
  show();
};
for (const button of scores()) button.onchange = () => answer({score: Number(button.value)});
$("remark").onchange = () => answer({remark: $("remark").value});
$("back").onclick = () => go(-1);
$("next").onclick = () => go(1);
$("save").onclick = save;
document.onkeydown = event => {
  if ($("rate").hidden || event.target.id === "remark" || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key >= "1" && event.key <= "5") answer({score: Number(event.key)});
  else if (event.key === "ArrowRight" || event.key === "Enter") go(1);
  else if (event.key === "ArrowLeft") go(-1);
  else return;
  event.preventDefault();
};
)js";

constexpr char kFormBody[] = R"html(<form id="begin">
<p>You will see pictures of posed bodies, one at a time: the body from outside, and a cut through the joint that bends,
with a colour for each tissue. Score how real each looks, by what you know of living bodies. Judge every picture by
itself; you can go back and change a score.</p>
<p>What you enter stays on this computer until you save it as a file and hand that in.</p>
<p><label>Your name or number <input id="rater" type="text" maxlength="60" required autofocus></label>
<button>Begin</button></p>
</form>
<div id="rate" hidden>
<div class="shown"><img id="body" alt="The body from outside"><img id="slice" alt="A cut through the joint"></div>
)html";
constexpr char kFormQuestions[] =
    R"html(<div class="bar" role="radiogroup" aria-label="How real does it look?"><b>How real does it look?&ensp;</b>
<label><input type="radio" name="score" value="1"> 1 not at all</label>
<label><input type="radio" name="score" value="2"> 2 little</label>
<label><input type="radio" name="score" value="3"> 3 partly</label>
<label><input type="radio" name="score" value="4"> 4 mostly</label>
<label><input type="radio" name="score" value="5"> 5 fully</label></div>
<p class="bar"><label for="remark">Remark</label><input id="remark" type="text" maxlength="500"></p>
<p class="bar"><button id="back">Back</button><button id="next">Next</button><button id="save">Save the scores</button>
<small>Keys: 1 to 5, arrows</small></p>
</div>
)html";

}  // namespace

std::vector<RatedPicture> rated_pictures(const Study& study, const std::vector<CellResult>& cells,
                                         const StudyFigures& figures) {
  std::vector<RatedPicture> pictures;
  for (const CellResult& cell : cells) {
    const auto column = std::find(figures.poses.begin(), figures.poses.end(), cell.cell.pose);
    if (!cell.done() || cell.cell.spacing != figures.spacing || column == figures.poses.end() ||
        study.poses[std::size_t(cell.cell.pose)].is_rest())
      continue;
    const auto at = [&](const PictureGrid& grid) {
      return grid.png[std::size_t(cell.cell.technique)][std::size_t(column - figures.poses.begin())];
    };
    pictures.push_back({code_of(cell), &cell, at(figures.bodies), at(figures.slices)});
  }
  std::sort(pictures.begin(), pictures.end(),
            [](const RatedPicture& a, const RatedPicture& b) { return a.code < b.code; });
  return pictures;
}

std::string rating_form(const Study& study, const std::vector<RatedPicture>& pictures, const TissueLegend& legend) {
  Json list = Json::array();
  for (const RatedPicture& picture : pictures)
    list.push_back({{"code", picture.code}, {"body", base64(picture.body)}, {"slice", base64(picture.slice)}});
  const std::string name = "Score the pictures: " + study.name;
  // Escapes "<", since the characters "</" in a string would end the script.
  std::string quoted = Json(study.name).dump(-1, ' ', true, Json::error_handler_t::replace);
  for (std::size_t at = 0; (at = quoted.find('<', at)) != std::string::npos;) quoted.replace(at, 1, "\\u003c");
  return "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
         "content=\"width=device-width, initial-scale=1\">\n<title>" +
         escaped(name) + "</title>\n<style>" + page_style() + kFormStyle +
         "</style>\n</head>\n<body>\n<main class=\"form\">\n<h1>" + escaped(name) +
         "</h1>\n<p><span id=\"count\"></span>&ensp;<small id=\"done\"></small></p>\n" + kFormBody + html_of(legend) +
         kFormQuestions + "</main>\n<script type=\"application/json\" id=\"pictures\">" + list.dump() +
         "</script>\n<script>const study = " + quoted + ";" + kFormScript + "</script>\n</body>\n</html>\n";
}

std::string rating_key(const Study& study, const std::vector<RatedPicture>& pictures) {
  std::string text = "picture,spacing_mm,pose,method\r\n";
  for (const RatedPicture& picture : pictures) {
    const StudyCell& cell = picture.cell->cell;
    const auto& spacing = study.spacings[std::size_t(cell.spacing)];
    text += picture.code + "," + (spacing ? number(*spacing) : "") + "," +
            csv_field(study.poses[std::size_t(cell.pose)].name) + "," +
            word_of(study.techniques[std::size_t(cell.technique)]) + "\r\n";
  }
  return text;
}

}  // namespace limber
