#include "robocell/scenes/place_links.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "robocell/base/suggestions.h"
#include "robocell/scenes/object_places.h"
#include "robocell/spec/problems.h"
#include "robocell/spec/validate.h"

namespace robocell::internal {
namespace {

// Returns the object of a start that a name stands for.
std::optional<size_t> Named(const std::string& name, const StartObjects& start) {
  for (size_t i = 0; i < start.objects.size(); ++i) {
    if (start.objects[i].name == name) return i;
  }
  const auto part = std::ranges::find(start.parts, name);
  if (name.empty() || part == start.parts.end()) return std::nullopt;
  return static_cast<size_t>(part - start.parts.begin());
}

// Returns the first of a kind, except the object itself.
std::optional<size_t> OfKind(const std::string& kind, const StartObjects& start, size_t except) {
  for (size_t i = 0; i < start.kinds.size(); ++i) {
    if (i != except && start.kinds[i] == kind) return i;
  }
  return std::nullopt;
}

bool IsKind(const std::string& name, const StartObjects& start) {
  return std::ranges::find(start.kinds, name) != start.kinds.end();
}

std::vector<std::string> NamesOf(const StartObjects& start) {
  std::vector<std::string> names;
  for (const SceneObject& object : start.objects) names.push_back(object.name);
  for (const auto& more : {start.parts, start.kinds}) {
    for (const std::string& name : more) {
      if (!name.empty() && std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

// Collects mistakes, each once.
struct Mistakes {
  Problems& problems;
  PlaceMistakes& reported;

  // Adds a mistake of the entry at `key`, of all entries for "".
  void Add(PlaceMistakeKind kind, const StatedPlaces& stated, const std::string& key,
           const std::string& text, const std::string& which = "") {
    if (!reported.insert({kind, stated.path, key, which}).second) return;
    const Problems::Scope scope(problems, stated.path);
    if (!stated.hook.empty())
      problems.Add(stated.hook + (key.empty() ? "" : ": '" + key + "'") + ": " + text);
    else if (key.empty())
      problems.Add(text);
    else
      problems.AddAt(key, text);
  }
};

// Adds mistakes of single entries.
void ValidateEntries(const StatedPlaces& stated, const StartObjects& start, Mistakes& mistakes) {
  for (const auto& [key, place] : stated.places.entries()) {
    Problems of_place;
    ValidateFields(*place, of_place);
    for (const std::string& line : LinesOf(of_place))
      mistakes.Add(PlaceMistakeKind::kNotValid, stated, key, line, line);
    if (Named(key, start) || IsKind(key, start) || start.may_come(key)) continue;
    mistakes.Add(PlaceMistakeKind::kNoSuchObject, stated, key,
                 NoSuchName("", "object", key, NamesOf(start)));
  }
}

// The entry for an object.
struct Entry {
  const StatedPlaces* stated;
  std::string key;
  const ObjectPlace* place;
};

std::optional<Entry> EntryOf(std::span<const StatedPlaces> stated, const StartObjects& start,
                             size_t i) {
  for (const StatedPlaces& each : stated) {
    const std::string part = start.parts.empty() ? "" : start.parts[i];
    for (const std::string& key : {start.objects[i].name, part, start.kinds[i]}) {
      if (const ObjectPlace* place = each.places.find(key)) return Entry{&each, key, place};
    }
  }
  return std::nullopt;
}

// Measures an object alone at the origin.
std::shared_ptr<const Landmarks> Alone(SceneObject object) {
  object.fixed = true;
  object.pos = Vec3{0, 0, 0};
  object.euler = {};
  object.quat = kIdentityQuat;
  object.attach_to = {};
  object.parked.reset();
  object.reset_root_pose = true;
  SceneSpec spec{.name = "'" + object.name + "' alone",
                 .timestep = 0.002,
                 .add_floor = false,
                 .add_skybox = false};
  spec.objects.push_back(std::move(object));
  return LandmarksOf(spec);
}

// Objects that are measured alone, each once.
class Measured {
 public:
  explicit Measured(const StartObjects& start) : start_(start), alone_(start.objects.size()) {}
  const std::shared_ptr<const Landmarks>& Of(size_t i) {
    if (!alone_[i]) alone_[i] = Alone(start_.objects[i]);
    return alone_[i];
  }

 private:
  const StartObjects& start_;
  std::vector<std::shared_ptr<const Landmarks>> alone_;
};

// Why a placement is impossible.
struct NoPlace {
  PlaceMistakeKind kind;
  std::string why;
};

// Returns why such a placement is impossible there; unset if possible.
std::optional<NoPlace> WhyNoPlace(const PlaceLink& link) {
  const std::string& name = link.place.reference();
  const Relation relation = link.place.relation();
  if (relation != Relation::kInside && link.marks->Tops(link.mark).empty()) {
    return NoPlace{PlaceMistakeKind::kNoTop,
                   fmt::format("nothing can lie {} '{}', which has no shape that collides",
                               ToString(relation), name)};
  }
  if (relation == Relation::kInside && link.marks->Floors(link.mark).empty()) {
    return NoPlace{PlaceMistakeKind::kNoHollow,
                   fmt::format("'{}' has no hollow with a level floor. Say on_top_of, or let the "
                               "source of the scene name a container (annotations)",
                               name)};
  }
  if (relation == Relation::kNextTo && !link.other && link.marks->Ground(link.mark).half_x <= 0) {
    return NoPlace{PlaceMistakeKind::kNoGround,
                   fmt::format("it is not known what '{}' stands on: no level face of a box and no "
                               "floor is under it. Let the source of the scene name a support "
                               "there (annotations)",
                               name)};
  }
  return std::nullopt;
}

// Data of a start's links.
struct Linking {
  const std::shared_ptr<const Landmarks>& base;
  std::span<const StatedPlaces> stated;
  const StartObjects& start;
  Mistakes& mistakes;
  Measured measured;

  std::string NoReference(const std::string& reference, size_t except) {
    std::vector<std::string> known = NamesOf(start);
    const auto add = [&](const Landmarks& marks) {
      for (const std::string& name : marks.Names()) {
        if (std::ranges::find(known, name) == known.end()) known.push_back(name);
      }
    };
    add(*base);
    for (size_t i = 0; i < start.objects.size(); ++i) {
      if (i != except) add(*measured.Of(i));
    }
    return NoSuchName("", "object or body", reference, known);
  }

  // Returns the object of the start that has a body of this name: a drawer of a cabinet.
  std::optional<size_t> WithPart(const std::string& body, size_t except) {
    for (size_t i = 0; i < start.objects.size(); ++i) {
      if (i != except && measured.Of(i)->Has(body)) return i;
    }
    return std::nullopt;
  }

  // The link of an object; unset when it has no entry, a wrong one, or one by kind that refers to
  // itself.
  std::optional<PlaceLink> Of(size_t i) {
    const std::optional<Entry> entry = EntryOf(stated, start, i);
    if (!entry) return std::nullopt;
    const auto wrong = [&](PlaceMistakeKind kind,
                           const std::string& why) -> std::optional<PlaceLink> {
      mistakes.Add(kind, *entry->stated, entry->key, why);
      return std::nullopt;
    };
    Problems of_place;
    ValidateFields(*entry->place, of_place);
    if (!of_place.empty()) return std::nullopt;  // it was reported
    const SceneObject& object = start.objects[i];
    const std::string& reference = entry->place->reference();
    PlaceLink link{.object = i, .place = *entry->place, .other = Named(reference, start)};
    if (link.other == i && entry->key != object.name) return std::nullopt;
    if (link.other == i) return wrong(PlaceMistakeKind::kRefersToItself, "it refers to itself");
    if (IsFixed(object)) {
      return wrong(PlaceMistakeKind::kIsFixed,
                   "it is a fixed object, which stays where its pose is");
    }
    if (object.has_pose())
      return wrong(PlaceMistakeKind::kHasAPose, "it has a `pos` too; remove one of the two");
    if (!link.other) link.other = OfKind(reference, start, i);
    if (link.other) {
      link.marks = measured.Of(*link.other);
      link.mark = start.objects[*link.other].name;
    } else if (base->Has(reference)) {
      link.marks = base;
      link.mark = reference;
    } else if (!start.may_come(reference) && !IsKind(reference, start)) {
      link.other = WithPart(reference, i);
      if (!link.other) return wrong(PlaceMistakeKind::kNoSuchReference, NoReference(reference, i));
      link.marks = measured.Of(*link.other);
      link.mark = reference;
    }
    if (link.marks) {
      if (const auto no = WhyNoPlace(link)) return wrong(no->kind, no->why);
    }
    if (link.place.relation() == Relation::kNextTo) link.own = measured.Of(i);
    return link;
  }
};

// Each after those that it refers to; without those of a circle, which are a problem.
std::vector<PlaceLink> InOrder(std::vector<PlaceLink> links, const StatedPlaces& stated,
                               const std::vector<SceneObject>& objects, Mistakes& mistakes) {
  std::vector<PlaceLink> ordered;
  while (!links.empty()) {
    const auto waits = [&](const PlaceLink& link) {
      return std::ranges::any_of(links, [&](const PlaceLink& l) { return link.other == l.object; });
    };
    const auto next = std::ranges::find_if_not(links, waits);
    if (next == links.end()) {
      std::vector<std::string> circle;
      for (const PlaceLink& link : links) circle.push_back(TextOf(link, objects));
      const std::string which = fmt::format("{}", fmt::join(circle, ", "));
      mistakes.Add(
          PlaceMistakeKind::kCircle, stated, "",
          fmt::format(
              "these run in a circle: {}. Let one of them lie on the support, without an entry",
              which),
          which);
      break;
    }
    ordered.push_back(std::move(*next));
    links.erase(next);
  }
  return ordered;
}

}  // namespace

std::shared_ptr<const Landmarks> LandmarksOf(const SceneSpec& scene,
                                             const std::optional<SceneAnnotations>& known) {
  SceneAnnotations annotations = DeriveAnnotations(scene);
  if (known && !known->supports.empty()) annotations.supports = known->supports;
  if (known && !known->containers.empty()) annotations.containers = known->containers;
  return std::make_shared<const Landmarks>(Scene::Build(scene), std::move(annotations));
}

std::string TextOf(const PlaceLink& link, const std::vector<SceneObject>& objects) {
  return fmt::format("'{}' {} '{}'", objects[link.object].name, ToString(link.place.relation()),
                     link.place.reference());
}

std::vector<PlaceLink> LinkPlaces(const std::shared_ptr<const Landmarks>& base,
                                  std::span<const StatedPlaces> stated, const StartObjects& start,
                                  Problems& problems) {
  PlaceMistakes reported;
  return LinkPlaces(base, stated, start, problems, reported);
}

std::vector<PlaceLink> LinkPlaces(const std::shared_ptr<const Landmarks>& base,
                                  std::span<const StatedPlaces> stated, const StartObjects& start,
                                  Problems& problems, PlaceMistakes& reported) {
  std::vector<PlaceLink> links;
  if (stated.empty()) return links;
  Mistakes mistakes{problems, reported};
  for (const StatedPlaces& each : stated) ValidateEntries(each, start, mistakes);
  Linking linking{base, stated, start, mistakes, Measured(start)};
  for (size_t i = 0; i < start.objects.size(); ++i) {
    if (auto link = linking.Of(i)) links.push_back(*std::move(link));
  }
  return InOrder(std::move(links), stated.front(), start.objects, mistakes);
}

}  // namespace robocell::internal
