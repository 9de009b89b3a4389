// SPDX-License-Identifier: MIT
#pragma once

#include "program/watch/picture_store.hpp"
#include "program/watch/watch.hpp"

namespace seqloop::program {

/// Takes what a loop has handed over since: frames, then pictures, then answers, so that nobody
/// hears of an answer before its frame. The watcher's side.
/// @param pictures keeps them, and says of how many frames one is wanted
/// @param on_frame called with each `Snapshot`
/// @param on_answer called with each `Answer`; returns false to leave it, and those after it, for
///   the next time
/// @param on_loop called with each `OtherLoop`, likewise
template <class OnFrame, class OnAnswer, class OnLoop>
void take(Watch& watch, PictureStore& pictures, OnFrame&& on_frame, OnAnswer&& on_answer,
          OnLoop&& on_loop) {
  while (const Snapshot* snapshot = watch.frames().front()) {
    on_frame(*snapshot);
    watch.frames().pop();
  }
  while (const SmallPicture* picture = watch.pictures().front()) {
    pictures.add(*picture);
    watch.pictures().pop();
  }
  watch.wishes.every.store(pictures.every(), std::memory_order_relaxed);
  while (const Answer* answer = watch.answers().front()) {
    if (!on_answer(*answer)) break;
    watch.answers().pop();
  }
  while (const OtherLoop* loop = watch.loops().front()) {
    if (!on_loop(*loop)) break;
    watch.loops().pop();
  }
}

}  // namespace seqloop::program
