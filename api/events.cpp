#include "api/events.hpp"

#include "api/report.hpp"

namespace unwrapd::api {

Event accepted_event(const Job& job) { return {0, "accepted", to_json(job)}; }

Event queued_event(std::int64_t seq, std::int64_t position) {
  return {seq, "queued", {{"position", position}}};
}

Event started_event(std::int64_t seq, int attempt) {
  return {seq, "started", {{"attempt", attempt}}};
}

Event stage_event(std::int64_t seq, const StageEvent& stage) {
  Event event{seq,
              "stage",
              {{"name", stage_name(stage.stage)},
               {"chart", stage.chart},
               {"of", stage.chart_count},
               {"fraction", finite(stage.fraction)}}};
  if (stage.lambda) event.data["lambda"] = finite(*stage.lambda);
  return event;
}

Event iteration_event(std::int64_t seq, const IterationEvent& iteration, double ms) {
  Event event{seq,
              "iteration",
              {{"chart", iteration.chart},
               {"i", iteration.iteration},
               {"energy", finite(iteration.energy)},
               {"rel_change", finite(iteration.rel_change)},
               {"angle", finite(iteration.angle)},
               {"area", finite(iteration.area)},
               {"flipped", iteration.flipped},
               {"fraction", finite(iteration.fraction)},
               {"ms", finite(ms)}}};
  if (iteration.lambda) event.data["lambda"] = finite(*iteration.lambda);
  return event;
}

Event note_event(std::int64_t seq, const Note& note) { return {seq, "note", to_json(note)}; }

Event final_event(std::int64_t seq, const Job& job) {
  return {seq, std::string(state_name(job.state)), to_json(job)};
}

Event gap_event(std::int64_t first, std::int64_t last) {
  return {last, "gap", {{"first", first}, {"last", last}}};
}

bool is_last(const Event& event) {
  const auto state = state_named(event.name);
  return state && is_final(*state);
}

std::string sse_frame(const Event& event) {
  const std::string data = to_text(event.data);
  const std::string id = event.seq > 0 ? "id: " + std::to_string(event.seq) + "\n" : "";
  return id + "event: " + event.name + "\ndata: " + data + "\n\n";
}

}  // namespace unwrapd::api
