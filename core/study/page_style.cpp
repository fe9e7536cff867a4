// SPDX-License-Identifier: AGPL-3.0-or-later
#include "core/study/page_style.h"

#include "core/base/asset.h"
#include "core/study/text.h"

namespace limber {

namespace {

// Returns the CSS of a font. If the font's file is missing, as in an incomplete installation, browsers use another
// font.
std::string font_face(const char* family, const char* weight, const char* file) {
  const auto path = find_asset(std::string("fonts/") + file);
  if (!path) return "";
  return std::string("@font-face{font-family:\"") + family + "\";font-weight:" + weight +
         ";src:url(data:font/woff2;base64," + base64(read_file(*path)) + ") format(\"woff2\")}\n";
}

constexpr char kStyle[] = R"css(
:root{--paper:#ffffff;--panel:#f4f5f7;--line:#d3d7dd;--line2:#bec4cc;--text:#1b1d21;--text2:#4a505a;--text3:#5d6470;
  --accent:#1a57b8;--ok:#0f7043;--bad:#b8232b;--ok-soft:#e3f3ea;--bad-soft:#fbe6e7;
 --t0:#2c66b0;--t1:#b86200;--t2:#0a7d68;--t3:#8a3fb0;--t4:#a03060;--void:#25282d}
@media (prefers-color-scheme:dark){:root{--paper:#1e2024;--panel:#25272c;--line:#33363d;--line2:#4a4e57;
  --text:#e6e8ec;--text2:#aeb4be;--text3:#969ca7;--accent:#8fbeff;--ok:#5ad19a;--bad:#ff7a80;--ok-soft:#1d3329;
  --bad-soft:#3d2427;
 --t0:#6fa8dc;--t1:#e3a24c;--t2:#3fb6a8;--t3:#c08be8;--t4:#e88bb0}}
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--text);font:15px/1.55 "Limber Sans",Inter,"Segoe UI",system-ui,
  "Liberation Sans",Arial,sans-serif;font-variant-numeric:tabular-nums}
main{max-width:1000px;margin:0 auto;padding:40px 28px 80px}
header{border-bottom:2px solid var(--text);padding-bottom:14px;margin-bottom:8px}
.kind{margin:0;color:var(--text3);font-size:13px}
h1{margin:2px 0 8px;font-size:30px;line-height:1.2;font-weight:600;letter-spacing:-.01em}
.lead{margin:0;color:var(--text2)}
h2{margin:52px 0 12px;font-size:21px;font-weight:600;line-height:1.25}
h3{margin:28px 0 8px;font-size:16px;font-weight:600}
p{max-width:46em;margin:8px 0 14px}
small{font-size:12px;font-weight:400;color:var(--text3)}
a{color:var(--accent)}
code,pre,.hash{font-family:"Limber Mono","JetBrains Mono","DejaVu Sans Mono",Menlo,Consolas,monospace;font-size:12px}
pre{background:var(--panel);border:1px solid var(--line);border-radius:4px;padding:12px 14px;overflow:auto;
  line-height:1.45}
figure{margin:22px 0 34px}
figcaption{color:var(--text2);font-size:13.5px;line-height:1.5;max-width:60em;margin-top:8px}
figure.table figcaption{margin:0 0 8px}
figcaption b{color:var(--text);font-weight:600}
.wide{overflow-x:auto}
table{border-collapse:collapse;font-size:13.5px;line-height:1.35}
thead th{font-weight:600;text-align:right;vertical-align:bottom;padding:5px 9px;border-bottom:1px solid var(--line2)}
thead tr:first-child th{border-top:1.5px solid var(--text)}
thead th:first-child{text-align:left;padding-left:0}
thead th.word{text-align:left}
thead th[colspan]{text-align:center}
thead th small,tbody small{display:block}
tbody td,tfoot td{text-align:right;padding:4px 9px;white-space:nowrap}
th.row{text-align:left;font-weight:500;padding:4px 9px 4px 0;white-space:nowrap}
td.word{text-align:left;color:var(--text2)}
tbody tr{border-bottom:1px solid var(--line)}
tfoot tr{border-top:1px solid var(--line2);font-weight:600}
tfoot th.row{font-weight:600}
tbody:last-child tr:last-child,tfoot tr:last-child{border-bottom:1.5px solid var(--text)}
.none{color:var(--text3)}
.note{border-left:3px solid var(--accent);padding:6px 12px;background:var(--panel)}
.references{margin:8px 0 20px;padding-left:26px;font-size:13.5px;line-height:1.45;max-width:60em}
.references li{margin:3px 0}
td.label-gate span{font-weight:600}td.label-gate.ok span{color:var(--ok)}
td.label-gate.bad{background:var(--bad-soft)}td.label-gate.bad span{color:var(--bad)}
.hash{text-align:left!important;color:var(--text2);white-space:normal!important;overflow-wrap:anywhere}
dl{display:grid;grid-template-columns:max-content 1fr;gap:4px 20px;margin:8px 0 20px}
dt{color:var(--text3)}dd{margin:0;overflow-wrap:anywhere}
svg{display:block;width:100%;height:auto;
  font:11px "Limber Sans",Inter,"Segoe UI",system-ui,"Liberation Sans",Arial,sans-serif;
  font-variant-numeric:tabular-nums}
svg.legend{display:inline-block;width:12px;height:12px;vertical-align:-1px}
svg text{fill:var(--text2)}
svg .title{fill:var(--text);font-weight:600;font-size:12px}
svg .tick,svg .muted{fill:var(--text3)}
svg .figure{fill:var(--text2);font-size:10.5px}
svg .grid{stroke:var(--line);stroke-width:1}
svg .axis{stroke:var(--text2);stroke-width:1}
svg .line{fill:none;stroke-width:1.8;stroke-linejoin:round}
svg .mark{stroke:var(--paper);stroke-width:1}
svg .name{font-weight:600}
.line.t0{stroke:var(--t0)}.line.t1{stroke:var(--t1)}.line.t2{stroke:var(--t2)}.line.t3{stroke:var(--t3)}.line.t4{
  stroke:var(--t4)}.line.t-none{stroke:var(--text3);stroke-dasharray:3 3}
.mark.t0,.bar.t0,svg .name.t0{fill:var(--t0)}.mark.t1,.bar.t1,svg .name.t1{fill:var(--t1)}.mark.t2,.bar.t2,
  svg .name.t2{fill:var(--t2)}.mark.t3,.bar.t3,svg .name.t3{fill:var(--t3)}.mark.t4,.bar.t4,svg .name.t4{
  fill:var(--t4)}
.mark.t-none,svg .name.t-none{fill:var(--text3)}
.line.exact{stroke-dasharray:6 3}svg .mark.exact{fill:var(--paper);stroke-width:1.8}svg .bar.exact{fill-opacity:.35;
  stroke-width:1.2}
.mark.t0.exact,.bar.t0.exact{stroke:var(--t0)}.mark.t1.exact,.bar.t1.exact{stroke:var(--t1)}.mark.t2.exact,
  .bar.t2.exact{stroke:var(--t2)}.mark.t3.exact,.bar.t3.exact{stroke:var(--t3)}.mark.t4.exact,.bar.t4.exact{
  stroke:var(--t4)}
p.legend{display:flex;flex-wrap:wrap;gap:4px 22px;margin:0 0 10px;font-size:13.5px}
.panels{display:grid;grid-template-columns:repeat(3,1fr);gap:18px 14px}
.panels.two{grid-template-columns:repeat(2,1fr)}
table.pictures{width:100%;table-layout:fixed;border-collapse:separate;border-spacing:4px}
table.pictures thead th{border:0;text-align:center;padding:0 4px 2px}
table.pictures thead th:first-child{width:112px}
table.pictures th.row{vertical-align:middle;white-space:normal;padding:0 8px 0 0}
table.pictures tr{border:0!important}
table.pictures tbody td{padding:0;text-align:center;white-space:normal}
table.pictures td .none{display:flex;min-height:70px;align-items:center;justify-content:center;
  background:var(--panel);font-size:12px}
table.pictures img{display:block;width:100%;height:auto;background:var(--void);border-radius:2px}
table.pictures td small{padding:3px 0}
.tissue-legend{display:flex;flex-wrap:wrap;gap:3px 14px;max-width:none;margin:8px 0 0;font-size:12.5px;
  color:var(--text2)}
.tissue-legend i{display:inline-block;width:12px;height:12px;margin-right:5px;border-radius:2px;vertical-align:-1px;
  border:1px solid var(--line2)}
.ramp{display:flex;flex-wrap:wrap;align-items:center;gap:4px 10px;margin-top:6px;font-size:12.5px;color:var(--text2)}
.ramp i{display:inline-block;width:180px;height:12px;background:linear-gradient(90deg,#2c5ca6,#c9cdd4,#c0572f);
  border-radius:2px}
.ramp b{display:inline-block;width:12px;height:12px;border-radius:2px;vertical-align:-1px}
.ramp .gap{margin-left:18px}.ramp .twice{background:#ff3ea5}.ramp .bone{background:#f3cf45}
table.gates{font-size:12px;width:100%}
table.gates thead th{padding:4px 5px;text-align:left;font-size:11.5px;line-height:1.25}
table.gates thead th[colspan]{text-align:left}
table.gates thead small{font-size:10.5px}
table.gates th.row{font-size:12px;padding-right:6px;vertical-align:top;padding-top:3px}
table.gates tbody{border-bottom:1px solid var(--line2)}
td.gate{text-align:left;padding:3px 5px;white-space:normal;vertical-align:top;line-height:1.25}
td.gate span{font-weight:600;margin-right:4px}
td.gate small{display:inline;font-size:11px}
td.gate.ok span{color:var(--ok)}
td.gate.bad{background:var(--bad-soft)}td.gate.bad span,td.gate.bad small,td.failed{color:var(--bad)}
td.failed{text-align:left;white-space:normal}
td.gate.na,td.gate.na small{color:var(--text3)}
th.pose{vertical-align:top}
@media (max-width:760px){main{padding:20px 14px 50px}.panels{grid-template-columns:repeat(auto-fill,minmax(240px,
  1fr))}table.pictures thead th:first-child{width:64px}}
@media print{
 @page{size:A4;margin:16mm 14mm 18mm}
 :root{--paper:#ffffff;--panel:#f4f5f7;--line:#d3d7dd;--line2:#bec4cc;--text:#000000;--text2:#333840;--text3:#5d6470;
  --accent:#1a57b8;--ok:#0f7043;--bad:#b8232b;--ok-soft:#e3f3ea;--bad-soft:#fbe6e7;--t0:#2c66b0;--t1:#b86200;
  --t2:#0a7d68;--t3:#8a3fb0;--t4:#a03060}
 *{-webkit-print-color-adjust:exact;print-color-adjust:exact}
 body{font-size:10pt;line-height:1.45}
 main{max-width:none;margin:0;padding:0}
 h1{font-size:20pt}h2{font-size:14pt;margin-top:26pt}
 h2,h3,h2+p,h2+p+p.note{break-after:avoid}
 p,li{orphans:3;widows:3}
 .references{font-size:8.6pt}.references li{break-inside:avoid}
 a{color:inherit;text-decoration:none}
 figure{margin:12pt 0 18pt;break-inside:avoid}
 tfoot{display:table-row-group}
 figure>svg{max-width:135mm!important}
 .panels{grid-template-columns:repeat(3,1fr)!important;gap:10px 8px}
 .panels.two{grid-template-columns:repeat(2,1fr)!important}
 figcaption{break-inside:avoid}
 figure.table figcaption{break-after:avoid}
 thead{display:table-header-group}
 tr,table.gates tbody{break-inside:avoid}
 figcaption,table{font-size:8.6pt}
 .wide{overflow:visible}
 thead th{padding:4px 5px}
 table.gates,table.gates th.row{font-size:7.4pt}table.gates thead th{font-size:7pt;padding:3px}
  table.gates thead small,td.gate small{font-size:6.6pt}td.gate{padding:2px 3px}
 tbody td,tfoot td,th.row{padding-top:2.5pt;padding-bottom:2.5pt}
 table.pictures thead th:first-child{width:96px}
 table.pictures th.row,table.pictures thead th{font-size:8pt}
 pre{white-space:pre-wrap;font-size:7.4pt;columns:2;break-inside:auto}
 pre.citation{columns:1;break-inside:avoid}
 .tissue-legend,.ramp{font-size:8pt;gap:2px 10px}
 h3+p,h3+ol{break-before:avoid}
 .hash{font-size:7pt}
}
)css";

}  // namespace

std::string page_style() {
  return font_face("Limber Sans", "400", "Inter-Regular.woff2") +
         font_face("Limber Sans", "600", "Inter-SemiBold.woff2") +
         font_face("Limber Mono", "400", "JetBrainsMono-Regular.woff2") + kStyle;
}

}  // namespace limber
