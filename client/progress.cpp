#include "client/progress.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <ostream>

#include "client/printable.hpp"

namespace unwrapd::client {
namespace {

constexpr std::size_t kWidestBar = 24;
constexpr std::size_t kNarrowestBar = 6;
constexpr auto kBarInterval = std::chrono::milliseconds(50);
constexpr auto kLineInterval = std::chrono::seconds(1);
constexpr const char* kEraseLine = "\r\x1b[K";

template <class T>
void take(const api::Json& data, const char* name, T& value) {
  const auto member = data.find(name);
  if (member != data.end() && member->is_number()) value = member->get<T>();
}

std::string format_number(const char* format, double value) {
  std::array<char, 32> text;
  const int length = std::snprintf(text.data(), text.size(), format, value);
  return {text.data(), static_cast<std::size_t>(std::clamp(length, 0, 31))};
}

std::string heading(const ProgressState& state) {
  std::string text = state.stage;
  if (state.lambda) text += " lambda " + format_number("%.6g", *state.lambda);
  if (state.charts > 0)
    text += " chart " + std::to_string(state.chart + 1) + "/" + std::to_string(state.charts);
  return text;
}

std::string figures(const ProgressState& state) {
  std::string text = format_number("%3.0f%%", 100 * state.fraction);
  if (state.iteration == 0) return text;
  text += " iteration " + std::to_string(state.iteration);
  text += " E " + format_number("%.4g", state.energy);
  text += " D_angle " + format_number("%.3f", state.angle);
  text += " D_area " + format_number("%.3f", state.area);
  return text + " flips " + std::to_string(state.flipped);
}

/// " [====>   ]", width characters with the space and the brackets; empty if that is too narrow.
std::string bar(double fraction, std::size_t width) {
  if (width < kNarrowestBar + 3) return {};
  const std::size_t cells = std::min(width - 3, kWidestBar);
  const auto filled = static_cast<std::size_t>(fraction * static_cast<double>(cells));
  std::string text(cells, ' ');
  std::fill_n(text.begin(), filled, '=');
  if (filled < cells) text[filled] = '>';
  return " [" + text + "]";
}

}  // namespace

ProgressState advance(ProgressState state, const std::string& event, const api::Json& data) {
  if (!data.is_object()) return state;
  if (event == "stage" || event == "iteration") {
    take(data, "chart", state.chart);
    take(data, "fraction", state.fraction);
    state.fraction = std::clamp(state.fraction, 0.0, 1.0);
    const auto lambda = data.find("lambda");
    const bool is_known = lambda != data.end() && lambda->is_number();
    state.lambda = is_known ? std::optional(lambda->get<double>()) : std::nullopt;
  }
  if (event == "stage") {
    const auto name = data.find("name");
    if (name != data.end() && name->is_string()) state.stage = printable(name->get<std::string>());
    take(data, "of", state.charts);
    state.iteration = 0;
  } else if (event == "iteration") {
    take(data, "i", state.iteration);
    take(data, "energy", state.energy);
    take(data, "angle", state.angle);
    take(data, "area", state.area);
    take(data, "flipped", state.flipped);
  } else if (event == "queued" || event == "started") {
    state.stage = printable(event);
  }
  return state;
}

std::string progress_line(const ProgressState& state, std::size_t width) {
  const std::string left = heading(state);
  const std::string right = figures(state);
  const std::size_t taken = left.size() + 1 + right.size();
  std::string line = left + bar(state.fraction, width > taken ? width - taken : 0) + " " + right;
  line.resize(std::min(line.size(), width));
  return line;
}

ProgressView::ProgressView(std::ostream& out, ProgressStyle style, std::size_t width)
    : out_(out), style_(style), width_(width) {}

ProgressView::~ProgressView() {
  if (style_ == ProgressStyle::bar && drawn_) out_ << kEraseLine << std::flush;
}

void ProgressView::show(const ProgressState& state, Clock::time_point now) {
  if (style_ == ProgressStyle::bar && is_due(kBarInterval, now)) draw_bar(state, now);
  if (style_ != ProgressStyle::lines) return;
  if (stages_.insert(state.stage).second) {
    if (pending_) write_line(*pending_, now);
    write_line(state, now);
  } else if (is_due(kLineInterval, now)) {
    write_line(state, now);
  } else if (state.iteration > 0) {
    pending_ = state;
  }
}

bool ProgressView::is_due(Clock::duration interval, Clock::time_point now) const {
  return !drawn_ || now - *drawn_ >= interval;
}

void ProgressView::draw_bar(const ProgressState& state, Clock::time_point now) {
  out_ << kEraseLine << progress_line(state, width_) << std::flush;
  drawn_ = now;
}

void ProgressView::write_line(const ProgressState& state, Clock::time_point now) {
  out_ << heading(state) << " " << figures(state) << std::endl;
  drawn_ = now;
  pending_.reset();
}

}  // namespace unwrapd::client
