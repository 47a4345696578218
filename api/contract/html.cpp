#include "api/contract/html.hpp"

namespace unwrapd::contract {
namespace {

/// Takes a line off the text, without its end.
std::string_view take_line(std::string_view& text) {
  const std::size_t end = text.find('\n');
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return line;
}

/// Closes what is open before something else opens, or nothing does.
class Blocks {
 public:
  void open(std::string_view name) {
    if (open_ == name) return;
    close();
    html_ += "<" + std::string(name) + ">";
    open_ = name;
  }
  void close() {
    if (!open_.empty()) html_ += "</" + open_ + ">\n";
    open_.clear();
  }
  void item(std::string_view text) { html_ += element("li", inline_html(text)); }
  void line(std::string_view text) { html_ += inline_html(text) + "\n"; }
  std::string take() {
    close();
    return std::move(html_);
  }

 private:
  std::string html_;
  std::string open_;
};

}  // namespace

std::string escaped(std::string_view text) {
  std::string html;
  for (const char c : text) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

std::string inline_html(std::string_view text) {
  std::string html;
  while (!text.empty()) {
    const std::size_t mark = text.find_first_of("`*");
    html += escaped(text.substr(0, mark));
    if (mark == std::string_view::npos) break;
    const std::size_t end = text.find(text[mark], mark + 1);
    if (end == std::string_view::npos || end == mark + 1) {  // it stands for itself
      html += escaped(text.substr(mark, 1));
      text.remove_prefix(mark + 1);
      continue;
    }
    const std::string_view inside = text.substr(mark + 1, end - mark - 1);
    html += element(text[mark] == '`' ? "code" : "em", escaped(inside));
    text.remove_prefix(end + 1);
  }
  return html;
}

std::string block_html(std::string_view text) {
  std::string paragraph;
  Blocks blocks;
  const auto flush = [&] {
    if (paragraph.empty()) return;
    blocks.open("p");
    blocks.line(paragraph);
    blocks.close();
    paragraph.clear();
  };
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    if (line.starts_with("- ")) {
      flush();
      blocks.open("ul");
      blocks.item(line.substr(2));
    } else if (line.empty()) {
      flush();
      blocks.close();
    } else {
      paragraph += (paragraph.empty() ? "" : "\n") + std::string(line);
    }
  }
  flush();
  return blocks.take();
}

std::string element(std::string_view name, std::string_view html) {
  const std::string tag(name);
  return "<" + tag + ">" + std::string(html) + "</" + tag + ">";
}

std::string code(std::string_view text) { return element("code", escaped(text)); }

std::string link_to(std::string_view id, std::string_view html) {
  return "<a href=\"#" + escaped(id) + "\">" + std::string(html) + "</a>";
}

}  // namespace unwrapd::contract
