#include "bench/output/page/page_text.h"

#include <cctype>
#include <sstream>
#include <vector>

#include "base/text.h"

namespace wobblebench::bench {

namespace {

constexpr std::string_view kReplacement = "\xef\xbf\xbd";

std::string_view reference_of(char c) {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    case '\'':
      return "&#39;";
    default:
      return {};
  }
}

bool may_be_linked(std::string_view target) {
  if (target.starts_with("https://")) return true;
  return !target.empty() && target.find(':') == std::string_view::npos && !target.starts_with("//");
}

/// "[text](target)" at the start of `text`: its length; 0: it is none.
struct Link {
  std::string_view text, target;
  std::size_t length = 0;
};
Link link_at(std::string_view text) {
  const std::size_t middle = text.find("](");
  if (!text.starts_with("[") || middle == std::string_view::npos) return {};
  const std::size_t end = text.find(')', middle);
  if (end == std::string_view::npos) return {};
  return {text.substr(1, middle - 1), text.substr(middle + 2, end - middle - 2), end + 1};
}

/// What stands between two `mark`s at the start of `text`; empty: it does not start so.
std::string_view between(std::string_view text, std::string_view mark) {
  if (!text.starts_with(mark)) return {};
  const std::size_t end = text.find(mark, mark.size());
  if (end == std::string_view::npos) return {};
  return text.substr(mark.size(), end - mark.size());
}

std::string inline_html(std::string_view text) {
  std::string html, plain;
  const auto flush = [&] {
    html += escaped(plain);
    plain.clear();
  };
  while (!text.empty()) {
    const std::string_view code = between(text, "`"), strong = between(text, "**");
    const Link link = link_at(text);
    if (!code.empty()) {
      flush();
      html += "<code>" + escaped(code) + "</code>";
      text.remove_prefix(code.size() + 2);
    } else if (!strong.empty()) {
      flush();
      html += "<strong>" + inline_html(strong) + "</strong>";
      text.remove_prefix(strong.size() + 4);
    } else if (link.length > 0) {
      flush();
      const std::string shown = inline_html(link.text);
      html += may_be_linked(link.target)
                  ? "<a href=\"" + escaped(link.target) + "\">" + shown + "</a>"
                  : shown;
      text.remove_prefix(link.length);
    } else {
      plain += text.front();
      text.remove_prefix(1);
    }
  }
  flush();
  return html;
}

/// Collects lines into paragraphs and lists.
class Paragraphs {
 public:
  void add(const std::string& line) {
    const bool item = line.starts_with("- ");
    if (line.empty() || item) end_paragraph();
    if (line.empty()) return end_list();
    if (item) {
      items_.push_back(line.substr(2));
    } else if (!items_.empty()) {
      items_.back() += "\n" + line;
    } else {
      paragraph_ += (paragraph_.empty() ? "" : "\n") + line;
    }
  }
  std::string finish() {
    end_paragraph();
    end_list();
    return html_;
  }

 private:
  void end_paragraph() {
    if (!paragraph_.empty()) html_ += "<p>" + inline_html(paragraph_) + "</p>\n";
    paragraph_.clear();
  }
  void end_list() {
    if (items_.empty()) return;
    html_ += "<ul>\n";
    for (const std::string& item : items_) html_ += "<li>" + inline_html(item) + "</li>\n";
    html_ += "</ul>\n";
    items_.clear();
  }

  std::string html_, paragraph_;
  std::vector<std::string> items_;
};

}  // namespace

std::string escaped(std::string_view text) {
  std::string html;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const char c = text.front();
    const std::string_view reference = reference_of(c);
    if (length == 0 || (is_control(c) && c != '\n' && c != '\t')) {
      html += kReplacement;
    } else if (!reference.empty()) {
      html += reference;
    } else {
      html += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return html;
}

std::string html_of_markdown(std::string_view markdown) {
  std::istringstream lines{std::string(markdown)};
  Paragraphs paragraphs;
  for (std::string line; std::getline(lines, line);) paragraphs.add(line);
  return paragraphs.finish();
}

std::string slug(std::string_view text) {
  std::string slug;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = byte < 0x80 && std::isalnum(byte) != 0;
    if (plain) slug += static_cast<char>(std::tolower(byte));
    if (!plain && !slug.empty() && slug.back() != '-') slug += '-';
  }
  while (slug.ends_with("-")) slug.pop_back();
  return slug;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  constexpr int kDigitBits = 6;
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  unsigned bits = 0;
  int count = 0;
  for (const char c : bytes) {
    bits = (bits << 8) | static_cast<unsigned char>(c);
    for (count += 8; count >= kDigitBits; count -= kDigitBits) {
      text += kDigits[(bits >> (count - kDigitBits)) & 63U];
    }
  }
  if (count > 0) text += kDigits[(bits << (kDigitBits - count)) & 63U];
  while (text.size() % 4 != 0) text += '=';
  return text;
}

}  // namespace wobblebench::bench
