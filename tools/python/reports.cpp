// SPDX-License-Identifier: MIT
#include "python/reports.hpp"

#include <string>

#include "python/plain_value.hpp"

namespace pybind11::detail {

/// A gate goes by its name.
template <>
class type_caster<seqloop::Gate> {
 public:
  PYBIND11_TYPE_CASTER(seqloop::Gate, const_name("str"));

  bool load(handle given, bool /*convert*/) {
    if (!isinstance<str>(given)) return false;
    const auto gate = seqloop::gate_of(given.cast<std::string>());
    if (gate) value = *gate;
    return gate.has_value();
  }

  static handle cast(seqloop::Gate gate, return_value_policy policy, handle parent) {
    return make_caster<std::string_view>::cast(seqloop::name(gate), policy, parent);
  }
};

}  // namespace pybind11::detail

namespace seqloop::python {
namespace {

namespace py = pybind11;

constexpr auto shown_frame =
    "The frame of the place's drive that shows what the answer's frame does: place + stood.";

constexpr auto answer_meaning =
    "What is said of one frame in the end. Each frame that was stepped has one, some steps after\n"
    "it: from `step`, or from `finish` for those that still wait then.\n\n"
    "Act on `gate` first:\n\n"
    "match: the robot has been here before, at `match`.\n"
    "unsure: it may have been, but the evidence does not suffice.\n"
    "new_place: it is somewhere new, for all that is known.\n"
    "not_unique: where uniqueness decides (paper=True), another place stands out as much.\n"
    "no_candidate: no line fits into the places that may be searched.\n"
    "frame_error: the frame could not be read or described.\n\n"
    "Of a Report, `gate` may also be one of these, and then it has no answer:\n\n"
    "warming_up: fewer than ds + 1 frames have been seen.\n"
    "waiting: the frames that wait for their answer are not sure yet.\n"
    "no_frame: never here; the program has it where a camera is lost.";

}  // namespace

void add_reports(py::module_& module) {
  add_plain_value<Match>(
      module, "Match", "The best place for a frame. Places are numbers of frames of the map.",
      member("place", &Match::place,
             "The place, by its number: from 0, as frames were added to the map, with those that\n"
             "became no place. Where the robot stood there, the first frame of that stop."),
      member("score", &Match::score,
             "Mean difference along the sequence, 0 to 2 between unit vectors; lower is better.\n"
             "NaN: no line leads there, evidence over time speaks for it."),
      member("uniqueness", &Match::uniqueness,
             "Score by the runner-up's, usually 0 to 1; lower is better. Above 1 or infinite: the\n"
             "runner-up is the better line. NaN: not defined."),
      member("velocity", &Match::velocity,
             "Rows of the map a keyframe: 1 where both drives are as fast. NaN: no line."),
      member("head", &Match::head, "The place of the newest frame of the sequence."),
      member("runner_up", &Match::runner_up,
             "Where uniqueness decides: the place that comes second. None: none, or an earlier\n"
             "frame's stood in; always None where the probability decides."),
      member("stood", &Match::stood,
             "Frames after `place` at which the robot still stood there; 0 where it drove."))
      .def_property_readonly("frame", &Match::frame, shown_frame);
  add_plain_value<Answer>(
      module, "Answer", answer_meaning,
      member("frame", &Answer::frame, "The frame that it is about, from 0."),
      member("gate", &Answer::gate, "What was decided: only 'match' is one. The class says more."),
      member("probability", &Answer::probability,
             "That the robot was at `match`, 0 to 1: of answers that say .9, nine in ten are\n"
             "right. NaN where uniqueness decides."),
      member("match", &Answer::match,
             "The best place, whether or not it suffices. None: nothing is known."));
  add_plain_value<Belief>(
      module, "Belief",
      "Where the robot is believed to be at the newest frame, by what has been seen so far.",
      member("place", &Belief::place, "The likeliest place, as Match.place."),
      member("probability", &Belief::probability,
             "That it is there, 0 to 1. No part of one whole with `new_place`: both may be low,\n"
             "and together they may come to more than 1."),
      member("new_place", &Belief::new_place,
             "That it is somewhere the map does not know, 0 to 1."),
      member("stood", &Belief::stood, "As Match.stood."))
      .def_property_readonly("frame", &Belief::frame, shown_frame);
  add_plain_value<Work>(
      module, "Work", "What a frame cost, in counts; the same on every machine.",
      member("candidates", &Work::candidates, "Places that got a score."),
      member("distances", &Work::distances, "Descriptor distances that were computed."),
      member("line_sums", &Work::line_sums, "Lines summed, of ds + 1 differences each."),
      member("scanned", &Work::scanned,
             "To relocalise: places looked at by 32 bytes of their sketches."),
      member("sketches", &Work::sketches,
             "To relocalise: pairs of sketches compared by 128 bytes."));
  add_plain_value<Report>(
      module, "Report",
      "What one step has to say: `answers` are final, `now` is what is believed so far.",
      member("answers", &Report::kept,
             "The answers that became due with this step, [] most often at the start: in order\n"
             "of their frames, but later reports may answer earlier frames."),
      member("now", &Report::now,
             "Where the robot is believed to be at `newest`. None before places can be compared."),
      member("newest", &Report::newest, "The frame that was stepped, from 0."),
      member("frame", &Report::frame,
             "The frame of the last of `answers`, None without one. Where uniqueness decides also\n"
             "the centre of a window that is not whole yet, which has no answer."),
      member("gate", &Report::gate,
             "That of the last of `answers`; without one 'warming_up', 'waiting' or\n"
             "'frame_error'. Answer says what each means."),
      member("match", &Report::match, "That of the last of `answers`; None without one."),
      member("k", &Report::k,
             "Candidate ranges in force for this frame; 0 where all places are candidates."),
      member("full_search", &Report::full_search, "Whether all places were candidates."),
      member("map_full", &Report::map_full,
             "Closing loops: the map is full, and the frame could not become a place."),
      member("work", &Report::work, "What the step cost."));
}

}  // namespace seqloop::python
