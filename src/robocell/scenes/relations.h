// Relations: the language of goals and starts: "mug inside tray", "drawer open 0.5". Each relation
// has a predicate, a sampler of states in which it holds, and words for instructions.
//
//   const StatedRelation goal = ParseRelation("red next_to blue 0.05");
//   const std::unique_ptr<BoundRelation> bound = BindRelation(scene, goal);
//   if (bound->Holds()) ...
//   for (const Pose& pose : bound->Sample(rng, 16).poses) ...   // red lies there: it holds
//
// A sentence is SUBJECT RELATION [REFERENCE] [NUMBERS]. Names are those of objects, bodies, joints,
// sites and geoms of the scene; one with spaces is written in quotes, "'left door' open 0.5". A
// number that is a bound may be written as one: "drawer open >= 0.5", "mug next_to box <= 0.1".
//
//   | sentence             | holds if                                                              |
//   | A on B               | A touches B from above                                                |
//   | A inside B           | A is in a hollow of B                                                 |
//   | A next_to B [gap]    | A is beside B, at most `gap` metres away (0.05)                       |
//   | A inserted B [share] | the deepest part of A is in hole B, by that share of its depth (0.8)   |
//   | A in_region B        | the middle of A is over the outline of B: a site, a geom, an object   |
//   | A in_region x y r    | ... within r metres of a place in the root frame                      |
//   | A upright [angle]    | the z axis of A is at most `angle` rad from the vertical (0.2)        |
//   | A open [share]       | joint A, or the one joint of A, is open by that share at least (0.3)  |
//   | A closed [share]     | ... is open by that share at most (0.15)                              |
//   | A pressed [share]    | as open (0.7), and once in an episode is enough                       |
//
// `held`, `wiped` and `poured_into` (task/held_relation.h) belong to tasks. RegisterRelation adds others. A joint is closed where
// the model has it at its reference, moved into its range, and open at the end of its range that is
// farther from there.
//
// Throws ArgumentError for sentences that are no relation, NotFoundError for names that the scene
// does not have. Threads: those of the scene; registering may be done by any.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "robocell/base/rng.h"
#include "robocell/math/pose.h"
#include "robocell/scene/scene.h"

namespace robocell {

// A sentence.
struct StatedRelation {
  std::string subject, relation, reference = {};
  std::vector<double> numbers = {};  // the relation's defaults fill in those that are missing
};

// States of the subject in which a relation holds.
struct RelationSamples {
  std::vector<Pose> poses = {};      // of the subject's root in the world
  std::optional<double> joint = {};  // position of the joint
};

// A relation in a scene. It requires up-to-date poses and contacts of the scene.
class BoundRelation {
 public:
  virtual ~BoundRelation() = default;
  virtual bool Holds() const = 0;
  // Returns how near the state is to it, 0 to 1; 1 if it holds.
  virtual double Progress() const { return Holds() ? 1 : 0; }
  // Returns states in which it holds, with everything else as it is now; at most `count` poses, none
  // of them inside of something else.
  virtual RelationSamples Sample(Rng& rng, int count) const = 0;
  // Sees each state that is judged, for relations about what has happened: what is wiped was covered
  // at some time.
  virtual void Watch() {}
  // Returns what it remembers of the episode, numbers that are 0 or 1, as many in every state.
  virtual std::vector<double> memory() const { return {}; }
  // Restores a memory; all 0 at the start of an episode.
  virtual void Recall(std::span<const double> /*memory*/) {}
};

// What a relation needs beside its subject.
enum class RelationReference { kNone, kRequired, kOrNumbers };
enum class RelationSubject { kObject, kJoint };

// A kind of relation.
struct RelationKind {
  RelationSubject subject = RelationSubject::kObject;
  RelationReference reference = RelationReference::kNone;
  // Numbers that may be left out, and their defaults.
  std::vector<double> defaults = {};
  // The numbers in place of the reference (kOrNumbers).
  int numbers_instead = 0;
  std::string numbers_text = {};  // "the largest gap in metres", for messages
  // ">=" or "<=", which may stand before the number; "" if none may.
  std::string comparison = {};
  // True for a number that is a share, above 0 and at most 1: with 0 it would always hold.
  bool is_share = false;
  // True if having held once in an episode is enough.
  bool is_momentary = false;
  // The words of an instruction, in which {0} is the subject and {1} the reference.
  std::string words;
  std::function<std::unique_ptr<BoundRelation>(const Scene&, const StatedRelation&)> bind;
};

// Returns the sentence, complete with the defaults of its relation.
StatedRelation ParseRelation(const std::string& text);
std::string TextOf(const StatedRelation& stated);
std::unique_ptr<BoundRelation> BindRelation(const Scene& scene, const StatedRelation& stated);
// Returns "put the mug inside the tray".
std::string WordsOf(const StatedRelation& stated, const std::string& subject,
                    const std::string& reference);

// Registers a relation for all threads. Throws ArgumentError for a name that is taken, and for words
// that are not a text with {0} and {1}.
void RegisterRelation(const std::string& name, RelationKind kind);
// Throws NotFoundError that lists the relations.
RelationKind FindRelation(const std::string& name);
std::vector<std::string> RelationNames();

}  // namespace robocell
