// SPDX-License-Identifier: AGPL-3.0-or-later
#include "editor/guide/book_html.h"

#include <filesystem>

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "editor/ui/asset_path.h"

namespace limber::editor {

namespace {

// Style sheet of the pages, with the colours of the editor's themes.
constexpr const char* kStyle =
    R"(:root{color-scheme:light dark;--paper:#fff;--side:#f4f5f7;--line:#d3d7dd;--text:#1b1d21;
--text2:#4a505a;--link:#1a57b8;--soft:#e3edfc;--code:#edeff2}
@media(prefers-color-scheme:dark){:root{--paper:#1e2024;--side:#25272c;--line:#3e424a;--text:#e6e8ec;--text2:#aeb4be;
--link:#8fbeff;--soft:#1f3961;--code:#2f3238}}
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--text);
font:17px/1.6 Inter,system-ui,-apple-system,"Segoe UI",sans-serif;
display:grid;grid-template-columns:290px minmax(0,1fr)}
nav{position:sticky;top:0;height:100vh;overflow-y:auto;background:var(--side);border-right:1px solid var(--line);
padding:20px 0 32px;font-size:15px;line-height:1.4}
nav .book{display:block;padding:0 20px 12px;font-size:19px;font-weight:600;color:var(--text)}
nav input{display:block;width:calc(100% - 40px);margin:0 20px 8px;padding:8px 10px;font:inherit;color:var(--text);
background:var(--paper);border:1px solid var(--line);border-radius:6px}
nav h2{margin:18px 20px 4px;font-size:13px;font-weight:600;letter-spacing:.03em;color:var(--text2)}
nav ul,#found{list-style:none;margin:0;padding:0}
nav li a{display:block;padding:4px 20px 4px 28px;color:var(--text);text-decoration:none}
nav li a:hover{background:var(--soft)}
nav li a[aria-current]{background:var(--soft);color:var(--link);font-weight:600}
#found a{padding:8px 20px;border-bottom:1px solid var(--line)}
#found span{display:block;font-size:13px;font-weight:400;color:var(--text2)}
#found p{padding:4px 20px;color:var(--text2)}
main{max-width:780px;width:100%;margin:0 auto;padding:36px 32px 60px}
h1{margin:0 0 16px;font-size:32px;line-height:1.2}
main h2{margin:34px 0 8px;font-size:20px}
a{color:var(--link)}
li{margin:6px 0}
main ul,main ol{padding-left:26px}
code,kbd{font:.88em/1.4 "JetBrains Mono",ui-monospace,Consolas,monospace;background:var(--code);border-radius:4px;
padding:.1em .35em;overflow-wrap:anywhere}
kbd{border:1px solid var(--line);border-bottom-width:2px;white-space:nowrap}
em{font-style:normal;font-weight:500;color:var(--text)}
figure{margin:22px 0}
figure img{display:block;max-width:100%;height:auto;border:1px solid var(--line);border-radius:6px}
figcaption{margin-top:6px;font-size:14px;color:var(--text2)}
.turn{display:flex;justify-content:space-between;gap:20px;margin-top:48px;padding-top:16px;
border-top:1px solid var(--line)}
@media(max-width:800px){body{display:block}
nav{position:static;height:auto;border-right:0;border-bottom:1px solid var(--line)}
nav #pages{display:none}nav:focus-within #pages{display:block}main{padding:24px 18px 48px}}
#pages[hidden]{display:none!important}
@media print{nav,.turn{display:none}body{display:block}main{max-width:none}}
)";

// Script of the search field. `pages` lists, for each page, its file, its title and its sentences.
constexpr const char* kSearch = R"(const field=document.getElementById("search"),found=document.getElementById("found"),
pages=document.getElementById("pages");
function best(page,words){
  const all=(page.title+" "+page.lines.join(" ")).toLowerCase();
  if(!words.every(w=>all.includes(w)))return null;
  if(words.every(w=>page.title.toLowerCase().includes(w)))return{rank:0,line:page.lines[0]||""};
  let line="",most=-1;
  for(const one of page.lines){
    const low=one.toLowerCase(),count=words.filter(w=>low.includes(w)).length;
    if(count>most){most=count;line=one}
  }
  return{rank:most==words.length?1:2,line};
}
function show(){
  const words=field.value.toLowerCase().split(/\s+/).filter(w=>w);
  pages.hidden=words.length>0;
  found.replaceChildren();
  if(!words.length)return;
  const hits=book.map(page=>({page,hit:best(page,words)})).filter(one=>one.hit);
  hits.sort((a,b)=>a.hit.rank-b.hit.rank);
  for(const{page,hit}of hits){
    const row=document.createElement("li"),link=document.createElement("a"),line=document.createElement("span");
    link.href=page.file;link.textContent=page.title;line.textContent=hit.line;
    link.append(line);row.append(link);found.append(row);
  }
  if(!hits.length){
    const none=document.createElement("p");
    none.textContent="No page has these words.";found.append(none);
  }
}
field.addEventListener("input",show);
field.addEventListener("keydown",event=>{
  if(event.key=="Escape"){field.value="";show()}
  const first=found.querySelector("a");
  if(event.key=="Enter"&&first)location.href=first.href;
});
document.querySelector("[aria-current]")?.scrollIntoView({block:"nearest"});
)";

std::string escape(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') out += "&amp;";
    else if (c == '<') out += "&lt;";
    else if (c == '>') out += "&gt;";
    else if (c == '"') out += "&quot;";
    else out += c;
  }
  return out;
}

std::string file_of(const Page& page) { return page.name == "guide" ? "index.html" : page.name + ".html"; }

std::string html_of(const Book& book, const Run& run) {
  const std::string text = escape(run.text);
  switch (run.style) {
    case Run::Style::Plain: return text;
    case Run::Style::Strong: return "<strong>" + text + "</strong>";
    case Run::Style::Name: return "<em>" + text + "</em>";
    case Run::Style::Code: return "<code>" + text + "</code>";
    case Run::Style::Key: return "<kbd>" + text + "</kbd>";
    case Run::Style::Link: break;
  }
  const int page = page_of(book, run.target);
  if (page < 0)
    throw Error("a link of the guide points to no page", run.target, "write the name of a page of the guide");
  return "<a href=\"" + file_of(book.pages[page]) + "\">" + text + "</a>";
}

std::string html_of(const Book& book, const Block& block) {
  std::string inside;
  for (const Run& run : block.runs) inside += html_of(book, run);
  switch (block.kind) {
    case Block::Kind::Title: return "<h1>" + inside + "</h1>\n";
    case Block::Kind::Heading: return "<h2>" + inside + "</h2>\n";
    case Block::Kind::Paragraph: return "<p>" + inside + "</p>\n";
    case Block::Kind::Point: return "<li>" + inside + "</li>\n";
    case Block::Kind::Step: return "<li value=\"" + std::to_string(block.number) + "\">" + inside + "</li>\n";
    case Block::Kind::Picture: break;
  }
  return "<figure><img src=\"" + escape(block.picture) + "\" alt=\"" + inside + "\"><figcaption>" + inside +
         "</figcaption></figure>\n";
}

std::string list_of(Block::Kind kind) {
  return kind == Block::Kind::Point ? "ul" : kind == Block::Kind::Step ? "ol" : "";
}

std::string main_of(const Book& book, const Page& page) {
  std::string html, list;
  for (const Block& block : page.blocks) {
    const std::string next = list_of(block.kind);
    if (next != list && !list.empty()) html += "</" + list + ">\n";
    if (next != list && !next.empty()) html += "<" + next + ">\n";
    list = next;
    html += html_of(book, block);
  }
  return list.empty() ? html : html + "</" + list + ">\n";
}

std::string contents_of(const Book& book, int here) {
  std::string html =
      "<nav>\n<a class=\"book\" href=\"index.html\">Limber</a>\n<input id=\"search\" type=\"search\" "
      "placeholder=\"Search the guide\" aria-label=\"Search the guide\">\n<ul id=\"found\"></ul>\n"
      "<div id=\"pages\">\n";
  for (const Chapter& chapter : book.chapters) {
    html += "<h2>" + escape(chapter.title) + "</h2>\n<ul>\n";
    for (const int page : chapter.pages)
      html += "<li><a href=\"" + file_of(book.pages[page]) + "\"" + (page == here ? " aria-current=\"page\"" : "") +
              ">" + escape(book.pages[page].title) + "</a></li>\n";
    html += "</ul>\n";
  }
  return html + "</div>\n</nav>\n";
}

std::string turning(const Book& book, int here) {
  const auto link = [&](int page, const char* before, const char* after) {
    if (page < 0 || page >= std::ssize(book.pages)) return std::string("<span></span>");
    return "<a href=\"" + file_of(book.pages[page]) + "\">" + before + escape(book.pages[page].title) + after + "</a>";
  };
  return "<div class=\"turn\">" + link(here - 1, "&larr; ", "") + link(here + 1, "", " &rarr;") + "</div>\n";
}

std::string page_html(const Book& book, int index) {
  const Page& page = book.pages[index];
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
         "content=\"width=device-width,initial-scale=1\">\n<title>" +
         escape(page.title) + (index == 0 ? "" : " - Limber") +
         "</title>\n<link rel=\"stylesheet\" href=\"guide.css\">\n</head>\n<body>\n" + contents_of(book, index) +
         "<main>\n" + main_of(book, page) + turning(book, index) +
         "</main>\n<script src=\"guide.js\"></script>\n</body>\n</html>\n";
}

// Returns the list of pages for the search script. The cover is left out, because it only lists the other pages'
// titles.
std::string search_data(const Book& book) {
  nlohmann::ordered_json pages = nlohmann::ordered_json::array();
  for (std::size_t p = 1; p < book.pages.size(); ++p) {
    nlohmann::ordered_json lines = nlohmann::ordered_json::array();
    for (std::size_t b = 1; b < book.pages[p].blocks.size(); ++b)
      for (const std::string& sentence : sentences_of(plain_text(book.pages[p].blocks[b]))) lines.push_back(sentence);
    pages.push_back({{"file", file_of(book.pages[p])}, {"title", book.pages[p].title}, {"lines", lines}});
  }
  return "const book=" + pages.dump() + ";\n";
}

}  // namespace

std::map<std::string, std::string> html_files(const Book& book) {
  std::map<std::string, std::string> files{{"guide.css", kStyle}, {"guide.js", search_data(book) + kSearch}};
  for (int p = 0; p < std::ssize(book.pages); ++p) files[file_of(book.pages[p])] = page_html(book, p);
  return files;
}

void write_guide_html(const Book& book, const Path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder / "images", error);
  if (error)
    throw Error("the folder cannot be made", (folder / "images").string(), "name a folder that you may write in");
  for (const Page& page : book.pages)
    for (const Block& block : page.blocks)
      if (block.kind == Block::Kind::Picture)
        write_file_atomically(folder / block.picture, read_file(asset("docs/guide/" + block.picture)));
  for (const auto& [name, contents] : html_files(book)) write_file_atomically(folder / name, contents);
}

}  // namespace limber::editor
