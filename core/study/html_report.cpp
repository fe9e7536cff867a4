// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/html_report.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>
#include <optional>
#include <set>

#include "core/batch/computing_sources.h"
#include "core/batch/machine.h"
#include "core/platform/local_time.h"
#include "core/study/charts.h"
#include "core/study/methods_text.h"
#include "core/study/page_style.h"
#include "core/study/text.h"
#include "core/study/time_table.h"

namespace limber {

namespace {

constexpr std::size_t kMostBars = 6;     // largest number of bars in a group; of more bars, only the mean is shown
constexpr std::size_t kMostPanels = 12;  // largest number of tissues that get a chart of their own
constexpr double kNarrow = 300;          // width of a tissue's chart, px
constexpr double kWide = 460;            // width of each of two charts side by side, px

std::string picture(const std::string& png, const std::string& what) {
  if (png.empty()) return "<span class=\"none\">not drawn</span>";
  return "<img alt=\"" + escaped(what) + "\" src=\"data:image/png;base64," + base64(png) + "\">";
}

class Page {
 public:
  Page(const Study& study, const std::vector<CellResult>& cells, const StudyFigures& figures, const ReportFacts& facts)
      : study_(study),
        cells_(cells),
        figures_(figures),
        facts_(facts) {
    for (const CellResult& cell : cells)
      if (cell.done()) at_[{cell.cell.spacing, cell.cell.pose, cell.cell.technique}] = &cell;
  }

  std::string operator()() {
    html_ =
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
        "content=\"width=device-width, initial-scale=1\">\n"
        "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" +
        escaped(study_.name) + "</title>\n<style>" + page_style() + "</style>\n</head>\n<body>\n<main>\n";
    head();
    summary();
    time();
    volume();
    pictures();
    worst();
    gates();
    tissues();
    if (facts_.sar) sar(*facts_.sar);
    if (facts_.rating) rating(*facts_.rating);
    methods();
    provenance();
    html_ += "</main>\n</body>\n</html>\n";
    return std::move(html_);
  }

 private:
  const CellResult* cell(int spacing, int pose, int technique) const {
    const auto found = at_.find({spacing, pose, technique});
    return found == at_.end() ? nullptr : found->second;
  }
  std::string finest() const {
    return study_.spacings[figures_.spacing] ? spacing_text(study_.spacings[figures_.spacing]) : "the input's spacing";
  }
  int techniques() const { return static_cast<int>(study_.techniques.size()); }
  int poses() const { return static_cast<int>(study_.poses.size()); }
  TechniqueLook look(int technique) const { return look_of(study_.techniques[technique]); }
  std::string technique_name(int technique) const { return title_of(study_.techniques[technique]); }
  std::string marked_name(int technique) const { return mark_svg(look(technique)) + " " + technique_name(technique); }
  std::vector<std::string> pose_names() const {
    std::vector<std::string> names;
    for (const DescribedPose& pose : study_.poses) names.push_back(pose.name);
    return names;
  }

  void section(const std::string& title, const std::string& id) {
    html_ += "<h2 id=\"" + id + "\">" + std::to_string(++sections_) + "&ensp;" + title + "</h2>\n";
  }
  void figure(const std::string& inside, const std::string& caption, const std::string& style = "") {
    html_ += "<figure" + (style.empty() ? "" : " class=\"" + style + "\"") + ">" + inside + "<figcaption><b>Figure " +
             std::to_string(++figures_shown_) + ".</b> " + caption + "</figcaption></figure>\n";
  }
  void table(const std::string& inside, const std::string& caption, const std::string& style = "") {
    html_ += "<figure class=\"table" + (style.empty() ? "" : " " + style) + "\"><figcaption><b>Table " +
             std::to_string(++tables_) + ".</b> " + caption + "</figcaption><div class=\"wide\"><table" +
             (style.empty() ? "" : " class=\"" + style + "\"") + ">" + inside + "</table></div></figure>\n";
  }

  // Times are processor seconds in a study, but wall-clock seconds in the results of an editor session.
  std::string seconds_word() const { return facts_.of_session ? "s" : "CPU s"; }
  std::string time_word() const { return facts_.of_session ? "elapsed time" : "processor time"; }
  static std::string counted(std::size_t count, const std::string& what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
  }

  static bool passes(const CellResult& cell) {
    return std::none_of(cell.gates.begin(), cell.gates.end(),
                        [](const QualityGate& gate) { return gate.state == GateState::Failed; });
  }

  void head() {
    html_ += std::string("<header><p class=\"kind\">Limber ") + (facts_.of_session ? "results" : "study") + "</p><h1>" +
             escaped(study_.name) + "</h1><p class=\"lead\">";
    if (facts_.of_session) {
      html_ += counted(cells_.size(), "result") + ": " + counted(poses(), "pose") + ", " +
               counted(techniques(), "technique") + ". Limber " LIMBER_VERSION ", " + escaped(facts_.date) +
               ".</p></header>\n";
      return;
    }
    std::string spacings;
    for (const auto& spacing : study_.spacings) spacings += (spacings.empty() ? "" : ", ") + spacing_text(spacing);
    html_ += std::to_string(study_.spacings.size()) + " spacing" + (study_.spacings.size() == 1 ? "" : "s") + " (" +
             escaped(spacings) + ") × " + std::to_string(poses()) + " pose" + (poses() == 1 ? "" : "s") + " × " +
             std::to_string(techniques()) + " technique" + (techniques() == 1 ? "" : "s") + " = " +
             std::to_string(cells_.size()) + " cells. " +
             (study_.phantom.empty() ? "Volume: " + escaped(study_.volume.filename().string())
                                     : "Volume: the procedural " + study_.phantom) +
             ". " + program() + ", written " + escaped(facts_.date) + ".</p></header>\n";
  }

  // The value with the largest magnitude among all poses of one technique at the finest spacing, and its pose and
  // tissue.
  struct Extreme {
    double value = 0;
    const CellResult* cell = nullptr;
    const TissueFigures* tissue = nullptr;
    void take(double candidate, const CellResult* of, const TissueFigures* in = nullptr) {
      if (!cell || std::abs(candidate) > std::abs(value)) value = candidate, cell = of, tissue = in;
    }
  };
  std::string pose_of(const Extreme& extreme) const {
    return extreme.cell ? escaped(study_.poses[extreme.cell->cell.pose].name) : "";
  }

  void summary() {
    section("Summary", "summary");
    std::size_t done = at_.size(), whole = 0;
    for (const auto& [key, one] : at_) whole += passes(*one);
    if (facts_.of_session)
      html_ += "<p>" + std::to_string(whole) + " of " + counted(done, "result") + (whole == 1 ? " passes" : " pass") +
               " every gate that applies. ";
    else
      html_ += "<p>" + std::to_string(done) + " of " + std::to_string(cells_.size()) + " cells are computed; " +
               std::to_string(whole) + " of them pass every gate that applies to them. ";
    if (!figures_.joint.empty())
      html_ += "The joint that turns the furthest is at the head of " + escaped(figures_.joint) + ". ";
    html_ +=
        "All changes are changes of volume, relative to the same tissue at rest at the same spacing. Changes of "
        "tissues can cancel in the total, so the tissue that changes most stands beside the total.</p>\n";

    std::string rows =
        "<thead><tr><th rowspan=\"2\">Technique</th><th colspan=\"2\">Total volume</th><th colspan=\"3\">Tissue that "
        "changes most</th><th rowspan=\"2\">Overlap<small>voxels</small></th>"
        "<th rowspan=\"2\">Time<small>" +
        seconds_word() + ", mean</small></th><th rowspan=\"2\">Memory<small>MB, peak</small></th><th rowspan=\"2\">" +
        (facts_.of_session ? "Results that pass" : "Cells that pass<small>all spacings</small>") +
        "</th></tr>"
        "<tr><th>change, %</th><th class=\"word\">pose</th><th>change, %</th><th class=\"word\">tissue</th><th "
        "class=\"word\">pose</th></tr></thead><tbody>";
    for (int t = 0; t < techniques(); ++t) {
      Extreme total, tissue;
      double seconds = 0, memory = 0;
      std::int64_t overlap = 0;
      int count = 0;
      for (int p = 0; p < poses(); ++p)
        if (const CellResult* one = cell(figures_.spacing, p, t)) {
          ++count;
          seconds += one->cpu_seconds;
          memory = std::max(memory, one->peak_memory_mb);
          overlap = std::max(overlap, one->overlap_voxels);
          total.take(one->volume_percent, one);
          for (const TissueFigures& of : one->tissues)
            if (of.voxels_before >= study_.gates.least_voxels && of.volume_percent)
              tissue.take(*of.volume_percent, one, &of);
        }
      int pass = 0, all = 0;
      for (const auto& [key, one] : at_)
        if (one->cell.technique == t) ++all, pass += passes(*one);
      rows += "<tr><th class=\"row\">" + marked_name(t) + "</th>";
      if (count == 0) {
        rows += "<td colspan=\"9\" class=\"none\">not computed</td></tr>";
        continue;
      }
      rows += "<td>" + signed_number(total.value, 2) + "</td><td class=\"word\">" + pose_of(total) + "</td>";
      rows += tissue.cell ? "<td>" + signed_number(tissue.value, 2) + "</td><td class=\"word\">" +
                                escaped(tissue.tissue->name) + "</td><td class=\"word\">" + pose_of(tissue) + "</td>"
                          : "<td class=\"none\" colspan=\"3\">no tissue is large enough</td>";
      rows += "<td>" + grouped(overlap) + "</td><td>" + fixed(seconds / count, 1) + "</td><td>" + fixed(memory, 0) +
              "</td><td>" + std::to_string(pass) + " of " + std::to_string(all) + "</td></tr>";
    }
    table(rows + "</tbody>",
          "Each technique at " + finest() +
              ": the largest change over all poses and the pose with this change, the largest number of "
              "voxels covered by two parts of the body, mean " +
              time_word() + " and largest memory of a " + (facts_.of_session ? "result" : "cell") +
              ". Tissues of fewer than " + grouped(study_.gates.least_voxels) + " voxels at rest are left out.");
  }

  void time() {
    section("Time", "time");
    BarChart bars{.unit = seconds_word(), .places = pose_names()};
    const bool too_many = bars.places.size() > kMostBars;
    if (too_many) bars.places = {"mean"};
    double most = 0;
    for (int t = 0; t < techniques(); ++t) {
      Series group{technique_name(t), look(t), {}};
      double sum = 0;
      int count = 0;
      for (int p = 0; p < poses(); ++p) {
        const CellResult* one = cell(figures_.spacing, p, t);
        if (one) sum += one->cpu_seconds, ++count, most = std::max(most, one->cpu_seconds);
        if (!too_many) group.values.push_back(one ? std::optional(one->cpu_seconds) : std::nullopt);
      }
      if (too_many) group.values = {count ? std::optional(sum / count) : std::nullopt};
      bars.groups.push_back(group);
    }
    bars.decimals = most < 1 ? 2 : most < 20 ? 1 : 0;
    figure(
        svg_of(bars),
        "Time by technique at " + finest() + ": " + time_word() + " of each " +
            (facts_.of_session ? "result" : "cell") + " from reading the volume to writing the result" +
            std::string(too_many ? ", mean over " + std::to_string(poses()) + " poses." : ", one bar for each pose.") +
            (facts_.of_session ? ""
                               : " Weights are computed once for each spacing, and their time is not included" +
                                     weights_note() + "."));

    std::vector<std::string> names;
    for (int t = 0; t < techniques(); ++t) names.push_back(marked_name(t));
    table(time_rows(study_, cells_, seconds_word(), names),
          "Time of a bent pose: median and range over the poses" +
              std::string(study_.repeats > 1 ? " and the " + std::to_string(study_.repeats) + " repeats of each" : "") +
              ", and the time of each pose divided by linear blend’s for the same pose." +
              (study_.repeats > 1 ? " All repeats gave the same voxels and numbers." : ""));

    if (study_.spacings.size() > 1) {
      LineChart lines{.unit = "CPU s", .x_unit = "spacing", .logarithmic = true};
      for (const auto& spacing : study_.spacings) lines.places.push_back(spacing_text(spacing));
      if (std::all_of(study_.spacings.begin(), study_.spacings.end(),
                      [](const auto& spacing) { return spacing.has_value(); }))
        for (const auto& spacing : study_.spacings) lines.positions.push_back(*spacing);
      for (int t = 0; t < techniques(); ++t) {
        Series series{technique_name(t), look(t), {}};
        for (int s = 0; s < std::ssize(study_.spacings); ++s) series.values.push_back(mean_seconds(s, t));
        lines.series.push_back(series);
      }
      Series weights{"Weights, computed once", {}, {}};
      for (int s = 0; s < std::ssize(study_.spacings); ++s) weights.values.push_back(seconds_of_weights(s));
      lines.series.push_back(weights);
      figure(svg_of(lines),
             "Time by resolution: mean processor time over the poses, against the edge of a voxel, on a logarithmic "
             "scale." +
                 tets_note());
    }
  }
  std::optional<double> mean_seconds(int spacing, int technique) const {
    double sum = 0;
    int count = 0;
    for (int p = 0; p < poses(); ++p)
      if (const CellResult* one = cell(spacing, p, technique)) sum += one->cpu_seconds, ++count;
    return count ? std::optional(sum / count) : std::nullopt;
  }
  // Returns a sentence with the mean number of tets in the FEM meshes at each spacing. It explains the computing times.
  std::string tets_note() const {
    std::string note;
    for (int s = 0; s < std::ssize(study_.spacings); ++s) {
      std::int64_t tets = 0, meshes = 0;
      for (const auto& [key, one] : at_)
        if (one->cell.spacing == s && one->mesh) tets += one->mesh->tets, ++meshes;
      if (meshes)
        note += (note.empty() ? "" : ", ") + grouped(tets / meshes) + " at " + spacing_text(study_.spacings[s]);
    }
    return note.empty() ? "" : " The time of finite elements depends on the number of tets, on average " + note + ".";
  }
  std::optional<double> seconds_of_weights(int spacing) const {
    for (const auto& [key, one] : at_)
      if (one->cell.spacing == spacing) return weights_seconds(facts_.out, *one);
    return {};
  }
  std::string weights_note() const {
    const auto seconds = seconds_of_weights(figures_.spacing);
    return seconds ? " (" + fixed(*seconds, 1) + " CPU s here)" : "";
  }

  // Returns one series for each technique. Its values are the percentages percent_of(cell) of all poses at the finest
  // spacing.
  template <class Percent>
  std::vector<Series> changes(const Percent& percent_of) const {
    std::vector<Series> all;
    for (int t = 0; t < techniques(); ++t) {
      Series series{technique_name(t), look(t), {}};
      for (int p = 0; p < poses(); ++p) {
        const CellResult* one = cell(figures_.spacing, p, t);
        series.values.push_back(one ? percent_of(*one) : std::nullopt);
      }
      all.push_back(series);
    }
    return all;
  }

  // Returns the tissues that have enough voxels for the quality gates, largest first.
  std::vector<const TissueFigures*> large_tissues() const {
    std::vector<const TissueFigures*> tissues;
    for (const auto& [key, one] : at_) {
      if (one->cell.spacing != figures_.spacing) continue;
      for (const TissueFigures& tissue : one->tissues)
        if (tissue.voxels_before >= study_.gates.least_voxels) tissues.push_back(&tissue);
      break;
    }
    std::stable_sort(tissues.begin(), tissues.end(),
                     [](auto a, auto b) { return a->voxels_before > b->voxels_before; });
    return tissues;
  }
  static const TissueFigures* tissue_of(const CellResult& cell, double label) {
    for (const TissueFigures& tissue : cell.tissues)
      if (tissue.label == label) return &tissue;
    return nullptr;
  }

  void volume() {
    section("Volume", "volume");
    LineChart chart{.unit = "change of volume, %",
                    .places = pose_names(),
                    .series = changes([](const CellResult& one) { return std::optional(one.volume_percent); }),
                    .is_signed = true};
    figure(svg_of(chart), "Change of volume by technique, all tissues together, at " + finest() +
                              ". A body that keeps its volume is at zero.");

    std::vector<const TissueFigures*> tissues = large_tissues();
    const std::size_t left_out = tissues.size() > kMostPanels ? tissues.size() - kMostPanels : 0;
    if (left_out) tissues.resize(kMostPanels);
    if (tissues.empty()) return;
    std::vector<LineChart> panels;
    double low = 0, high = 0;
    for (const TissueFigures* tissue : tissues) {
      LineChart panel{.title = tissue->name + "  (" + grouped(tissue->voxels_before) + " voxels)",
                      .unit = "%",
                      .places = pose_names(),
                      .is_signed = true,
                      .names = false,
                      .width = int(kNarrow),
                      .height = 200};
      panel.series = changes([&](const CellResult& one) {
        const TissueFigures* same = tissue_of(one, tissue->label);
        return same ? same->volume_percent : std::nullopt;
      });
      for (const Series& series : panel.series)
        for (const auto& value : series.values)
          if (value) low = std::min(low, *value), high = std::max(high, *value);
      panels.push_back(panel);
    }
    const double pad = 0.04 * std::max(high - low, 0.1);
    std::string inside = legend() + "<div class=\"panels\">";
    for (LineChart& panel : panels) {
      panel.low = low - pad;
      panel.high = high + pad;
      panel.low = nice_floor(*panel.low, high - low);
      panel.high = nice_ceiling(*panel.high, high - low);
      inside += "<div>" + svg_of(panel) + "</div>";
    }
    figure(inside + "</div>", "Change of volume by technique, tissue by tissue, at " + finest() +
                                  ", all on one scale. Tissues of " + grouped(study_.gates.least_voxels) +
                                  " voxels or more at rest" +
                                  (left_out ? ", the " + std::to_string(kMostPanels) + " largest of them" : "") +
                                  "; figures are in section <a href=\"#tissues\">Tissues</a>.");
  }
  static double nice_step(double range) {
    const double power = std::pow(10, std::floor(std::log10(std::max(range, 1e-3) / 5)));
    for (const double nice : {1.0, 2.0, 5.0})
      if (nice * power >= range / 5) return nice * power;
    return 10 * power;
  }
  static double nice_floor(double value, double range) {
    return nice_step(range) * std::floor(value / nice_step(range) + 1e-9);
  }
  static double nice_ceiling(double value, double range) {
    return nice_step(range) * std::ceil(value / nice_step(range) - 1e-9);
  }

  std::string legend() const {
    std::string text = "<p class=\"legend\">";
    for (int t = 0; t < techniques(); ++t) text += "<span>" + marked_name(t) + "</span>";
    return text + "</p>";
  }

  // Lays the pictures out as a table, one row for each technique and one column for each pose.
  std::string grid(const PictureGrid& pictures, const std::vector<int>& columns, const std::string& what) const {
    std::string html = "<table class=\"pictures\"><thead><tr><th></th>";
    for (const int pose : columns) html += "<th>" + escaped(study_.poses[pose].name) + "</th>";
    html += "</tr></thead><tbody>";
    for (int t = 0; t < techniques(); ++t) {
      html += "<tr><th class=\"row\"><span>" + marked_name(t) + "</span></th>";
      for (std::size_t c = 0; c < columns.size(); ++c)
        html += "<td>" +
                picture(pictures.png[t][c], what + ", " + technique_name(t) + ", " + study_.poses[columns[c]].name) +
                "</td>";
      html += "</tr>";
    }
    return html + "</tbody></table>";
  }

  void pictures() {
    section("Pictures", "pictures");
    const std::string shown = study_.poses.size() > figures_.poses.size()
                                  ? " The first " + std::to_string(figures_.poses.size()) + " of " +
                                        std::to_string(study_.poses.size()) + " poses."
                                  : "";
    if (figures_.no_bodies.empty())
      figure(grid(figures_.bodies, figures_.poses, "Body") + html_of(figures_.bodies.legend),
             "The posed volumes in 3D at " + finest() + ", technique by pose, all at one scale: each picture is " +
                 fixed(figures_.bodies.width_mm, 0) + " mm wide" + view_words() + shown,
             "grid");
    else
      html_ +=
          "<p class=\"note\"><b>No pictures in 3D:</b> " + escaped(figures_.no_bodies) + ". " +
          (facts_.of_session ? ""
                             : "Run the same command again with a build of Limber that can draw in 3D; the finished "
                               "cells are not computed again.") +
          "</p>\n";
    figure(grid(figures_.slices, figures_.poses, "Slice") + html_of(figures_.slices.legend),
           "The same cut " + where() + ", with unsmoothed voxels. Each picture is " +
               fixed(figures_.slices.width_mm, 0) + " mm wide; the bar is 50 mm." + shown,
           "grid");
  }
  std::string view_words() const {
    return figures_.joint.empty() ? "." : ", seen from the side of the bend and turned by 35° towards its fold.";
  }
  std::string where() const {
    return figures_.joint.empty()
               ? "through the middle"
               : "through the joint of " + escaped(figures_.joint) + ", perpendicular to the axis about which it turns";
  }

  void worst() {
    const auto any = [](const PictureGrid& grid) {
      return std::any_of(grid.png.begin(), grid.png.end(), [](const auto& row) { return !row[0].empty(); });
    };
    if (figures_.largest_pose < 0 || (!any(figures_.ratios) && !any(figures_.overlaps))) return;
    section("Worst places", "worst");
    std::string html = "<table class=\"pictures maps\"><thead><tr><th></th>";
    for (int t = 0; t < techniques(); ++t) html += "<th>" + marked_name(t) + "</th>";
    html += "</tr></thead><tbody>";
    const std::string pose = study_.poses[figures_.largest_pose].name;
    for (const auto& [name, of] : {std::pair{"Volume ratio", &figures_.ratios}, {"Overlap", &figures_.overlaps}}) {
      html += std::string("<tr><th class=\"row\"><span>") + name + "</span></th>";
      for (int t = 0; t < techniques(); ++t)
        html += "<td>" + picture(of->png[t][0], std::string(name) + ", " + technique_name(t) + ", " + pose) +
                overlap_words(of == &figures_.overlaps, t) + "</td>";
      html += "</tr>";
    }
    html +=
        "</tbody></table><div class=\"ramp\"><span>½ or less: compressed</span><i></i><span>2 or more: "
        "stretched</span><span class=\"gap\"><b class=\"twice\"></b> covered by two parts of the body</span><span><b "
        "class=\"bone\"></b> covered by two bones</span></div>";
    figure(html + html_of(figures_.overlaps.legend),
           "Maps at " + escaped(pose) + ", " + finest() + ", cut " + where() +
               ". Above: ratio of the posed volume to the rest volume around each voxel (determinant of the "
               "deformation; grey is 1). Below: voxels that two parts of the body covered, over the tissues in dull "
               "colours; the number counts them in the whole volume.",
           "grid");
    if (figures_.close_ups.empty()) return;

    html =
        "<table class=\"pictures\"><thead><tr><th></th><th>Cut open</th><th>Tissues</th><th>Volume "
        "ratio</th></tr></thead><tbody>";
    for (const CloseUp& close : figures_.close_ups) {
      const std::string what =
          technique_name(close.cell->cell.technique) + ", " + study_.poses[close.cell->cell.pose].name;
      html += "<tr><th class=\"row\"><span>" + marked_name(close.cell->cell.technique) + "<br>" +
              escaped(study_.poses[close.cell->cell.pose].name) + "<br><small>" + grouped(close.region.voxels) +
              " of " + grouped(close.region.of) + " voxels<br>ratio " + fixed(close.region.least, 2) + " to " +
              fixed(close.region.most, 2) + "</small></span></th>";
      html +=
          "<td>" +
          (close.body.empty() ? "<span class=\"none\">not drawn</span>" : picture(close.body, "Close-up, " + what)) +
          "</td><td>" + picture(close.tissues, "Slice, " + what) + "</td><td>" +
          picture(close.ratio, "Ratio, " + what) + "</td></tr>";
    }
    figure(html + "</tbody></table>" + html_of(figures_.close_up_legend),
           "Close-ups of the worst region of each technique at " + finest() +
               ", worst first: the box of about 48 mm with most voxels whose surroundings are compressed to less than "
               "half or stretched to more than twice their volume (with their number, out of all tissue voxels in the "
               "box). Each picture is 96 mm wide, the bar is 10 mm.",
           "grid");
  }
  std::string overlap_words(bool is_overlap, int technique) const {
    if (!is_overlap) return "";
    const CellResult* one = cell(figures_.spacing, figures_.largest_pose, technique);
    return one ? "<small>" + grouped(one->overlap_voxels) + " voxels</small>" : "";
  }

  // Typesets a figure with a true minus sign, and with no-break spaces so that no line ends within the figure.
  static std::string typeset(const std::string& figure) {
    std::string text;
    for (const char c : figure) text += c == ' ' ? "\u00a0" : c == '-' && text.empty() ? "\u2212" : std::string(1, c);
    return text;
  }
  static std::string gate_cell(const QualityGate& gate) {
    if (gate.state == GateState::NotMeasured) return "<td class=\"gate na\"><span>–</span></td>";
    const bool passed = gate.state == GateState::Passed,
               names_worst = !gate.worst.empty() && (!passed || gate.id == "tissues");
    return std::string("<td class=\"gate ") + (passed ? "ok\"><span>✓</span>" : "bad\"><span>✗</span>") + "<small>" +
           escaped(typeset(gate.figure) + (names_worst ? " " + gate.worst : "")) + "</small></td>";
  }

  void gates() {
    section("Gates", "gates");
    if (at_.empty()) {
      html_ += "<p>No cell is computed yet.</p>\n";
      return;
    }
    html_ +=
        "<p>A gate is a number with a limit. ✓: the number is within its limit; ✗: it is not; –: there is nothing to "
        "judge. A failed gate is a finding about the technique in that pose, not an error of the run.</p>\n";
    const std::vector<QualityGate> kinds = gates_of("", study_.gates);
    const std::size_t of_body = body_gates("").size();
    gate_tables("Gates of the body", kinds, 0, of_body);
    gate_tables("Gates", kinds, of_body, kinds.size());
  }
  // Adds one table of quality gates for each spacing. Its columns are the gates `first` to `end` - 1.
  void gate_tables(const std::string& title, const std::vector<QualityGate>& all, std::size_t first, std::size_t end) {
    const std::vector<QualityGate> kinds(all.begin() + std::ptrdiff_t(first), all.begin() + std::ptrdiff_t(end));
    std::string meanings;
    for (const QualityGate& gate : kinds) meanings += " <b>" + escaped(gate.name) + ":</b> " + escaped(gate.meaning);
    for (int s = 0; s < std::ssize(study_.spacings); ++s) {
      std::string rows = "<thead><tr><th colspan=\"2\">" + std::string(facts_.of_session ? "Result" : "Cell") + "</th>";
      for (const QualityGate& gate : kinds) rows += "<th>" + escaped(gate.name) + "</th>";
      rows += "</tr></thead>";
      for (int p = 0; p < poses(); ++p) {
        rows += "<tbody>";
        for (int t = 0; t < techniques(); ++t) {
          rows += "<tr>";
          if (t == 0)
            rows += "<th class=\"row pose\" rowspan=\"" + std::to_string(techniques()) + "\">" +
                    escaped(study_.poses[p].name) + "</th>";
          rows += "<th class=\"row\">" + marked_name(t) + "</th>";
          if (const CellResult* one = cell(s, p, t))
            for (std::size_t g = first; g < end; ++g) rows += gate_cell(one->gates[g]);
          else
            rows += "<td class=\"bad failed\" colspan=\"" + std::to_string(kinds.size()) + "\">" + failure_of(s, p, t) +
                    "</td>";
          rows += "</tr>";
        }
        rows += "</tbody>";
      }
      table(rows, title + " at " + spacing_text(study_.spacings[s]) + "." + (s ? "" : meanings), "gates");
    }
  }
  std::string failure_of(int spacing, int pose, int technique) const {
    for (const CellResult& one : cells_)
      if (one.cell.spacing == spacing && one.cell.pose == pose && one.cell.technique == technique)
        return "✗ not computed: " + escaped(one.failure);
    return "not computed";
  }

  void tissues() {
    section("Tissues", "tissues");
    html_ += "<p>Change of volume in %, at " + finest() + ". Each label of " + grouped(study_.gates.least_voxels) +
             " voxels or more at rest has a gate: ✓ it changes by at most " + number(study_.gates.tissue_percent) +
             " %, ✗ by more. Even a rigid rotation changes the number of voxels of a label: by up to 2 % for a few "
             "thousand voxels, and by more for fewer." +
             (facts_.of_session ? "" : " Every figure of every cell is in cells.csv and cells.json beside this page.") +
             "</p>\n";
    for (int p = 0; p < poses(); ++p) {
      const CellResult* any = nullptr;
      for (int t = 0; t < techniques() && !any; ++t) any = cell(figures_.spacing, p, t);
      if (!any) continue;
      std::string rows = "<thead><tr><th>Tissue</th><th>Label</th><th>Voxels at rest</th>";
      for (int t = 0; t < techniques(); ++t) rows += "<th>" + marked_name(t) + "<small>change, %</small></th>";
      rows += "</tr></thead><tbody>";
      for (const TissueFigures& tissue : any->tissues) {
        rows += "<tr><th class=\"row\">" + escaped(tissue.name) + "</th><td>" + number(tissue.label) + "</td><td>" +
                grouped(tissue.voxels_before) + "</td>";
        for (int t = 0; t < techniques(); ++t) rows += change_cell(cell(figures_.spacing, p, t), tissue);
        rows += "</tr>";
      }
      rows +=
          "</tbody><tfoot><tr><th class=\"row\">All tissue</th><td></td><td>" + grouped(any->voxels_before) + "</td>";
      for (int t = 0; t < techniques(); ++t) {
        const CellResult* one = cell(figures_.spacing, p, t);
        rows += one ? "<td>" + signed_number(one->volume_percent, 2) + "</td>" : "<td class=\"none\">–</td>";
      }
      table(rows + "</tr>" + mass_exact_row(p) + "</tfoot>", escaped(study_.poses[p].name) + ", " + finest() + ".",
            "tissues");
    }
  }
  // Returns the table row with the number of voxels that changed tissue to make masses exact.
  std::string mass_exact_row(int pose) const {
    if (std::none_of(study_.techniques.begin(), study_.techniques.end(),
                     [](const Technique& technique) { return technique.mass_exact; }))
      return "";
    std::string row = "<tr><th class=\"row\">Voxels changed by mass-exact</th><td></td><td></td>";
    for (int t = 0; t < techniques(); ++t) {
      const CellResult* one = cell(figures_.spacing, pose, t);
      row += one && one->mass_exact_voxels ? "<td>" + grouped(*one->mass_exact_voxels) + "</td>"
                                           : "<td class=\"none\">–</td>";
    }
    return row + "</tr>";
  }
  // Returns the cell of a table with the change of a label and, if the label is large enough, its gate.
  std::string change_cell(const CellResult* one, const TissueFigures& at_rest) const {
    const TissueFigures* tissue = one ? tissue_of(*one, at_rest.label) : nullptr;
    if (!tissue || !tissue->volume_percent) return "<td class=\"none\">–</td>";
    const std::string change = signed_number(*tissue->volume_percent, 2);
    const std::optional<bool> passed = label_passes(*tissue, study_.gates);
    if (!passed) return "<td>" + change + "</td>";
    return std::string("<td class=\"label-gate ") + (*passed ? "ok\"><span>✓</span> " : "bad\"><span>✗</span> ") +
           change + "</td>";
  }

  void sar(const SarFigures& sar) {
    section("Absorption of radio waves", "sar");
    const SarFigures::Sphere& sphere = sar.sphere;
    html_ +=
        "<p>Specific absorption rate (SAR) of the posed bodies in a plane wave of " + number(sar.frequency_hz / 1e6) +
        " MHz and 1 W/m², polarized along " + escaped(sar.polarization) + " and going towards +" +
        escaped(sar.towards) + ", computed by openEMS with cells of " + number(sar.cell_mm) +
        " mm. For a ball of muscle with cells of " + number(sphere.cell_mm) +
        " mm, the same method gives an absorbed power of " + fixed(1e3 * sphere.absorbed, 2) +
        " mW, where Mie's exact solution is " + fixed(1e3 * sphere.by_mie, 2) + ": " +
        signed_number(sphere.difference_percent, 1) + " %" +
        (std::abs(sphere.difference_percent) > 10 ? "; <b>this is more than 10 %: do not trust what follows</b>" : "") +
        ".</p>\n";
    if (!sar.outdated.empty()) {
      std::string poses;
      for (const std::string& pose : sar.outdated) poses += (poses.empty() ? "" : ", ") + pose;
      html_ += "<p class=\"note\"><b>Left out:</b> SAR of " + escaped(poses) +
               " was computed from cells that have changed since. Run <code>sar_openems.py study</code> again.</p>\n";
    }
    if (sar.bodies.empty()) return;
    const CellResult& first = *sar.bodies.front().cell;
    LineChart average{.title = "Average over all tissue", .unit = "mW/kg", .names = false, .width = int(kWide)},
        peak{.title = "Largest average over 10 g", .unit = "mW/kg", .names = false, .width = int(kWide)};
    Series averages{technique_name(first.cell.technique), look(first.cell.technique), {}}, peaks = averages;
    std::string rows =
        "<thead><tr><th>Pose</th><th>Average<small>mW/kg</small></th><th>Peak over 10 "
        "g<small>mW/kg</small></th><th>Mass<small>kg</small></th><th>Tissue "
        "cells</th><th>Time<small>s</small></th></tr></thead><tbody>";
    for (const SarFigures::Body& body : sar.bodies) {
      const std::string& pose = study_.poses[body.cell->cell.pose].name;
      for (LineChart* chart : {&average, &peak}) chart->places.push_back(pose);
      averages.values.push_back(1000 * body.average);
      peaks.values.push_back(1000 * body.peak_10g);
      rows += "<tr><th class=\"row\">" + escaped(pose) + "</th><td>" + fixed(1000 * body.average, 2) + "</td><td>" +
              fixed(1000 * body.peak_10g, 1) + "</td><td>" + fixed(body.mass_kg, 3) + "</td><td>" +
              grouped(body.cells) + "</td><td>" + fixed(body.seconds, 0) + "</td></tr>";
    }
    average.series = {averages};
    peak.series = {peaks};
    figure("<div class=\"panels two\"><div>" + svg_of(average) + "</div><div>" + svg_of(peak) + "</div></div>",
           "SAR against pose, of the volumes posed by " + technique_name(first.cell.technique) + " at " +
               spacing_text(study_.spacings[first.cell.spacing]) +
               ". Left: over the whole body. Right: the largest average over a cube of 10 g of tissue.");
    table(rows + "</tbody>", "SAR of each pose.");
  }

  void rating(const RatingResult& rating) {
    section("Visual realism", "realism");
    const auto figure_of = [](const std::optional<double>& value) { return value ? fixed(*value, 2) : "–"; };
    html_ += "<p>" + counted(rating.raters.size(), "rater") + " scored " + counted(rating.pictures, "picture") +
             " from " + std::to_string(kLeastScore) + " (not at all real) to " + std::to_string(kMostScore) +
             " (fully real), each in a different order and without knowing the techniques. Agreement: Krippendorff’s "
             "alpha (ordinal) " +
             figure_of(rating.alpha) + ", Cohen’s kappa (quadratic weights, mean over pairs of raters) " +
             figure_of(rating.kappa) + ".</p>\n";
    std::string rows =
        "<thead><tr><th>Technique</th><th>Mean score</th><th>Standard "
        "deviation</th><th>Scores</th></tr></thead><tbody>";
    for (int t = 0; t < techniques(); ++t) {
      const TechniqueScore& score = rating.techniques[std::size_t(t)];
      rows += "<tr><th class=\"row\">" + marked_name(t) + "</th>" +
              (score.scores ? "<td>" + fixed(score.mean, 2) + "</td><td>" + fixed(score.deviation, 2) + "</td>"
                            : "<td class=\"none\">–</td><td class=\"none\">–</td>") +
              "<td>" + std::to_string(score.scores) + "</td></tr>";
    }
    table(rows + "</tbody>", "Visual realism of each technique over all raters and bent poses at " + finest() +
                                 ". Every score is in scores.csv.");
  }

  void methods() {
    section("Methods", "methods");
    const MethodsText text = methods_text(study_, cells_, facts_.of_session);
    html_ += text.paragraphs;
    if (!text.references.empty()) html_ += "<h3>References</h3><ol class=\"references\">" + text.references + "</ol>\n";
  }

  void provenance() {
    section("Provenance", "provenance");
    std::set<std::string> machines;
    double seconds = 0;
    for (const auto& [key, one] : at_) machines.insert(one->machine), seconds += one->cpu_seconds;
    std::string list;
    const auto fact = [&](const std::string& name, const std::string& value) {
      list += "<dt>" + name + "</dt><dd>" + value + "</dd>";
    };
    fact("Program", program() + ", sources <code>" + std::string(computing_sources()).substr(0, 12) + "</code>");
    if (!facts_.of_session) fact("Command", "<code>" + escaped(facts_.command) + "</code>");
    fact("Written on", escaped(facts_.date));
    if (!facts_.of_session) {
      for (const std::string& machine : machines) fact("Computed on", escaped(machine));
      fact("Processor time", fixed(seconds / 60, 1) + " min for all cells");
      fact("Weights", escaped(study_.weights));
      fact("Finite elements", "quality " + escaped(study_.quality));
      fact("Joints", study_.fit_joints ? "fitted to the bones before each pose, so that bones do not overlap"
                                       : "as the rig has them, shifted where bones would overlap");
      fact("Labels", study_.nearest ? "label of the nearest voxel at rest"
                                    : "label with the largest share, interpolated at rest");
    }
    html_ += "<dl>" + list + "</dl>\n";

    std::set<std::pair<std::string, std::string>> inputs;
    for (const auto& [key, one] : at_)
      for (const auto& [path, hash] : one->inputs)
        inputs.emplace(path.starts_with("../../") ? path.substr(6) : path, hash);
    std::string rows = "<thead><tr><th>File</th><th>SHA-256</th></tr></thead><tbody>";
    for (const auto& [path, hash] : inputs)
      rows += "<tr><th class=\"row\">" + escaped(path) + "</th><td class=\"hash\">" + hash + "</td></tr>";
    table(rows + "</tbody>",
          facts_.of_session ? "Input files of the results, with hashes of their contents."
                            : "Input files of the cells, with hashes of their contents. Each cell's folder has the job "
                              "that computed it: <code>limber job cells/…/job.json</code> computes it again.",
          "inputs");
    warnings();
    if (!facts_.of_session) html_ += "<h3>The study</h3><pre>" + escaped(to_json(study_)) + "</pre>\n";
    html_ += "<h3>How to cite</h3><pre class=\"citation\">" + citation() + "</pre>\n";
  }
  std::string citation() const {
    const std::string note = facts_.commit.empty() ? "" : "  note    = {commit " + escaped(facts_.commit) + "},\n";
    return "@software{limber,\n  author  = {{The Limber contributors}},\n  title   = {Limber: posing of labelled voxel "
           "anatomy},\n  version = {" LIMBER_VERSION "},\n" +
           note + "  year    = {" + facts_.date.substr(0, 4) + "},\n  license = {AGPL-3.0-or-later}\n}";
  }
  std::string program() const {
    return "Limber " LIMBER_VERSION + (facts_.commit.empty() ? "" : ", commit " + escaped(facts_.commit));
  }
  void warnings() {
    std::map<std::string, std::vector<std::string>> by_text;
    for (const auto& [key, one] : at_)
      for (const std::string& warning : one->warnings)
        by_text[warning].push_back(facts_.of_session
                                       ? study_.poses[one->cell.pose].name + ", " + technique_name(one->cell.technique)
                                       : text_of(study_, one->cell));
    if (by_text.empty()) return;
    std::string list;
    for (const auto& [text, where] : by_text) {
      list += "<li>" + escaped(text) + " <small>(" + escaped(where.front());
      list += (where.size() > 1 ? " and " + std::to_string(where.size() - 1) + " more" : "") + ")</small></li>";
    }
    html_ +=
        "<h3>" + std::string(facts_.of_session ? "Warnings" : "Warnings of the cells") + "</h3><ul>" + list + "</ul>\n";
  }

  const Study& study_;
  const std::vector<CellResult>& cells_;
  const StudyFigures& figures_;
  const ReportFacts& facts_;
  std::map<std::tuple<int, int, int>, const CellResult*> at_;
  std::string html_;
  int sections_ = 0, figures_shown_ = 0, tables_ = 0;
};

}  // namespace

std::string date_text() {
  const std::tm local = local_time(std::time(nullptr));
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M", &local);
  return text;
}

std::string html_report(const Study& study, const std::vector<CellResult>& cells, const StudyFigures& figures,
                        const ReportFacts& facts) {
  return Page(study, cells, figures, facts)();
}

}  // namespace limber
