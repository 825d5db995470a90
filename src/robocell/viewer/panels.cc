#include "robocell/viewer/panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>

#include "robocell/base/error.h"
#include "robocell/base/suggestions.h"

namespace robocell::internal {
namespace {

constexpr double kDoubleClick = 0.35;  // seconds
constexpr int kForPaths = 20;          // pixels, so that a field shows "recording.mp4"

std::string Lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

// A long name is known by its end.
std::string Short(std::string_view name) {
  constexpr size_t kMost = mjMAXUINAME - 1;
  if (name.size() <= kMost) return std::string(name);
  return ".." + std::string(name.substr(name.size() - (kMost - 2)));
}

// Copies a text into one of mjUI's fixed size.
template <size_t kSize>
void Copy(std::string_view text, char (&to)[kSize]) {
  const size_t size = std::min(text.size(), kSize - 1);
  std::copy_n(text.data(), size, to);
  to[size] = 0;
}

std::string Lines(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) {
    text += text.empty() ? "" : "\n";
    text += Short(name);
  }
  return text;
}

std::vector<std::string> Containing(std::vector<std::string> names, const char* filter) {
  const std::string wanted = Lower(filter);
  std::erase_if(names, [&](const std::string& name) {
    return Lower(name).find(wanted) == std::string::npos;
  });
  return names;
}

// Parts names so that each part, with `more` before it, fits into a box of mjUI.
std::vector<std::vector<std::string>> Parted(const std::vector<std::string>& names,
                                             const std::vector<std::string>& more) {
  std::vector<std::vector<std::string>> parts = {more};
  for (const std::string& name : names) {
    std::vector<std::string> longer = parts.back();
    longer.push_back(name);
    if (longer.size() <= mjMAXUIMULTI && Lines(longer).size() < mjMAXUITEXT) {
      parts.back() = std::move(longer);
    } else {
      parts.push_back(more);
      parts.back().push_back(name);
    }
  }
  return parts;
}

}  // namespace

void NameChoice::Choose() {
  const std::vector<std::string> names = Containing(all(), filter);
  const bool has_chosen = std::find(names.begin(), names.end(), chosen) != names.end();
  std::vector<std::vector<std::string>> parts;
  if (has_chosen) parts = Parted(names, {});
  if (parts.size() != 1) {  // it is on every page
    std::vector<std::string> others = names;
    std::erase(others, chosen);
    parts = Parted(others, {chosen});
  }
  pages = static_cast<int>(parts.size());
  page = std::clamp(page, 0, pages - 1);
  shown = parts[static_cast<size_t>(page)];
  index = static_cast<int>(std::find(shown.begin(), shown.end(), chosen) - shown.begin());
}

void NameChoice::TakeIndex() {
  if (index >= 0 && static_cast<size_t>(index) < shown.size())
    chosen = shown[static_cast<size_t>(index)];
}

void NameRows::Choose() {
  const std::vector<std::string> names =
      Containing(all ? all() : std::vector<std::string>(), filter);
  const int count = static_cast<int>(names.size());
  pages = std::max(1, (count + kRows - 1) / kRows);
  page = std::clamp(page, 0, pages - 1);
  const auto first = names.begin() + std::min(count, page * kRows);
  const auto last = names.begin() + std::min(count, (page + 1) * kRows);
  shown.assign(first, last);
}

Panels::Panels(PanelValues& values) : values_(values), left_(new mjUI), right_(new mjUI) {
  for (mjUI* ui : {left_.get(), right_.get()}) {
    std::memset(ui, 0, sizeof *ui);
    ui->spacing = mjui_themeSpacing(0);
    ui->color = mjui_themeColor(0);
    ui->userdata = nullptr;
  }
  left_->spacing.total += kForPaths;
  left_->rectid = 1;
  left_->auxid = 0;
  right_->rectid = 2;
  right_->auxid = 1;
}

void Panels::Section(mjUI& ui, const char* name, bool open) {
  mjuiDef defs[2] = {};
  defs[0].type = mjITEM_SECTION;
  Copy(name, defs[0].name);
  defs[0].state = open ? mjSECT_OPEN : mjSECT_CLOSED;
  defs[1].type = mjITEM_END;
  mjui_add(&ui, defs);
}

void Panels::Item(mjUI& ui, int type, std::string_view name, void* data, const std::string& other,
                  PanelItem item, int row, int state) {
  mjuiDef defs[2] = {};
  defs[0].type = type;
  Copy(Short(name), defs[0].name);
  defs[0].state = state;
  defs[0].pdata = data;
  Copy(other, defs[0].other);
  defs[1].type = mjITEM_END;
  mjui_addToSection(&ui, ui.nsect - 1, defs);
  mjuiSection& section = ui.sect[ui.nsect - 1];
  section.item[section.nitem - 1].userid = static_cast<int>(entries_.size());
  entries_.push_back({item, row});
}

void Panels::List(mjUI& ui, NameRows& rows, PanelItem list) {
  Item(ui, mjITEM_EDITTXT, "Name has", rows.filter, "", list);
  if (rows.pages > 1) {
    Item(ui, mjITEM_SLIDERINT, "Page", &rows.page, fmt::format("0 {}", rows.pages - 1), list);
  }
}

void Panels::Choice(mjUI& ui, std::string_view name, NameChoice& choice, PanelItem item) {
  Item(ui, mjITEM_SELECT, name, &choice.index, Lines(choice.shown), item);
  if (choice.pages == 1 && choice.filter[0] == 0) return;
  Item(ui, mjITEM_EDITTXT, "Name has", choice.filter, "", PanelItem::kCameraList);
  Item(ui, mjITEM_SLIDERINT, "Page", &choice.page, fmt::format("0 {}", choice.pages - 1),
       PanelItem::kCameraList);
}

void Panels::AddRun(mjUI& ui) {
  PanelValues& v = values_;
  if (v.pauses) Item(ui, mjITEM_RADIO, "", &v.run, "Pause\nRun", PanelItem::kRun);
  if (v.resets) {
    Item(ui, mjITEM_BUTTON, "One step", nullptr, "", PanelItem::kStepOnce);
    Item(ui, mjITEM_BUTTON, "Reset", nullptr, "", PanelItem::kReset);
  }
  Item(ui, mjITEM_BUTTON, "Screenshot", nullptr, "", PanelItem::kScreenshot);
  Item(ui, mjITEM_CHECKINT, "Help", &v.help, "", PanelItem::kOther);
  Item(ui, mjITEM_CHECKINT, "Timing", &v.timing, "", PanelItem::kOther);
  Item(ui, mjITEM_BUTTON, "Close", nullptr, "", PanelItem::kClose);
}

void Panels::AddSpeed(mjUI& ui) {
  PanelValues& v = values_;
  if (v.paces) Item(ui, mjITEM_EDITNUM, "Requested", &v.factor, "1 0 1000", PanelItem::kFactor);
  Item(ui, mjITEM_STATIC, "Measured", nullptr, "-", PanelItem::kOther);
  if (!v.paces) return;
  Item(ui, mjITEM_BUTTON, "Real time", nullptr, "", PanelItem::kRealTime);
  Item(ui, mjITEM_BUTTON, "Unlimited", nullptr, "", PanelItem::kUnpaced);
}

void Panels::AddRecorder(mjUI& ui) {
  PanelValues& v = values_;
  Item(ui, mjITEM_EDITTXT, "Path", v.video_path, "", PanelItem::kOther);
  Choice(ui, "Camera", v.video_cameras, PanelItem::kVideoCamera);
  Item(ui, mjITEM_SELECT, "Size", &v.video_size, "360p\n480p\n720p\n1080p\n2K\n4K",
       PanelItem::kOther);
  Item(ui, mjITEM_EDITINT, "FPS", &v.video_fps, "1 1 240", PanelItem::kOther);
  Item(ui, mjITEM_BUTTON, "Start", nullptr, "", PanelItem::kRecord);
  Item(ui, mjITEM_BUTTON, "Stop", nullptr, "", PanelItem::kStopRecording);
  Item(ui, mjITEM_STATIC, "State", nullptr, "idle", PanelItem::kOther);
}

void Panels::AddView(mjUI& ui) {
  PanelValues& v = values_;
  Choice(ui, "Camera", v.cameras, PanelItem::kCamera);
  Item(ui, mjITEM_CHECKINT, "Contacts", &v.contacts, "", PanelItem::kFlags);
  Item(ui, mjITEM_CHECKINT, "Collisions", &v.collision, "", PanelItem::kFlags);
  Item(ui, mjITEM_CHECKINT, "Joint axes", &v.joint_axes, "", PanelItem::kFlags);
  Item(ui, mjITEM_CHECKINT, "Transparent", &v.transparent, "", PanelItem::kFlags);
  Item(ui, mjITEM_CHECKINT, "Shadows", &v.shadows, "", PanelItem::kFlags);
}

void Panels::Build(const mjrContext* context, int width, int height, const Range& joint,
                   const Range& control) {
  PanelValues& v = values_;
  // What the user opened stays open.
  std::vector<std::string> open = {"Run", "View"};
  if (left_->nsect > 0) open.clear();
  for (const mjUI* ui : {left_.get(), right_.get()}) {
    for (int i = 0; i < ui->nsect; ++i) {
      if (ui->sect[i].state == mjSECT_OPEN) open.emplace_back(ui->sect[i].name);
    }
  }
  const auto section = [&](mjUI& ui, const char* name) {
    Section(ui, name, std::find(open.begin(), open.end(), name) != open.end());
  };
  entries_.clear();
  for (mjUI* ui : {left_.get(), right_.get()}) {
    ui->nsect = 0;
    ui->mousesect = ui->mouseitem = ui->mouseclicks = ui->mousesectcheck = 0;
    ui->editchanged = nullptr;
    ui->editsect = 0;
  }
  const std::string kinds = "Body\nSite\nTCP\nCamera";
  mjUI& l = *left_;
  section(l, "Run");
  AddRun(l);
  section(l, "RTF");
  AddSpeed(l);

  section(l, "Frames");
  Item(l, mjITEM_SELECT, "Kind", &v.frame_kind, kinds, PanelItem::kFrameList);
  List(l, v.frames, PanelItem::kFrameList);
  for (size_t i = 0; i < v.frames.shown.size(); ++i) {
    Item(l, mjITEM_CHECKINT, v.frames.shown[i], &v.frames.on[i], "", PanelItem::kFrame,
         static_cast<int>(i));
  }
  Item(l, mjITEM_SLIDERNUM, "Length m", &v.frame_length, "0.01 0.5", PanelItem::kFrameLength);
  Item(l, mjITEM_CHECKINT, "Names", &v.frame_labels, "", PanelItem::kFlags);
  Item(l, mjITEM_BUTTON, "No frames", nullptr, "", PanelItem::kNoFrames);

  section(l, "Trace");
  Item(l, mjITEM_SELECT, "Kind", &v.trace_kind, kinds, PanelItem::kTraceList);
  List(l, v.traces, PanelItem::kTraceList);
  for (size_t i = 0; i < v.traces.shown.size(); ++i) {
    Item(l, mjITEM_CHECKINT, v.traces.shown[i], &v.traces.on[i], "", PanelItem::kTrace,
         static_cast<int>(i));
  }
  Item(l, mjITEM_SLIDERNUM, "Seconds", &v.trace_length, "0 60", PanelItem::kTraceLength);
  Item(l, mjITEM_BUTTON, "Clear", nullptr, "", PanelItem::kClearTraces);

  section(l, "Perturb");
  Item(l, mjITEM_RADIO, "Drag", &v.drag, "View\nPull\nTurn", PanelItem::kOther);
  Item(l, mjITEM_STATIC, "Body", nullptr, "-", PanelItem::kOther);
  Item(l, mjITEM_BUTTON, "Deselect", nullptr, "", PanelItem::kDeselect);

  section(l, "Recorder");
  AddRecorder(l);

  mjUI& r = *right_;
  section(r, "View");
  AddView(r);

  const auto sliders = [&](const char* name, NameRows& rows, PanelItem list, PanelItem item,
                           const Range& range) {
    section(r, name);
    List(r, rows, list);
    for (size_t i = 0; i < rows.shown.size(); ++i) {
      const SliderRange limits = range(rows.shown[i]);
      Item(r, mjITEM_SLIDERNUM, rows.shown[i], &rows.value[i],
           fmt::format("{:.6g} {:.6g}", limits.low, limits.high), item, static_cast<int>(i));
    }
  };
  sliders("Joints", v.joints, PanelItem::kJointList, PanelItem::kJoint, joint);
  sliders("Controls", v.controls, PanelItem::kControlList, PanelItem::kControl, control);
  Layout(width, height, context);
  Modify(*left_, context);
  Modify(*right_, context);
}

void Panels::Modify(mjUI& ui, const mjrContext* context) {
  mjui_resize(&ui, context);
  mjr_addAux(ui.auxid, ui.width, ui.maxheight, ui.spacing.samples,
             const_cast<mjrContext*>(context));
  mjui_update(-1, -1, &ui, &state_, context);
}

void Panels::Layout(int width, int height, const mjrContext* context) {
  mjui_resize(left_.get(), context);
  mjui_resize(right_.get(), context);
  mjrRect* rect = state_.rect;
  state_.nrect = 4;
  rect[0] = {0, 0, width, height};
  const int left = left_shown ? std::min(left_->width, width) : 0;
  const int right = right_shown ? std::min(right_->width, width - left) : 0;
  rect[1] = {0, 0, left, height};
  rect[2] = {width - right, 0, right, height};
  rect[3] = {left, 0, std::max(0, width - left - right), height};
}

// As MuJoCo's own adapters of window systems do.
void Panels::Track(const InputEvent& event, double now) {
  mjuiState& s = state_;
  const bool mouse = event.type == InputEvent::kMove || event.type == InputEvent::kPress ||
                     event.type == InputEvent::kRelease;
  s.dx = s.dy = s.sx = s.sy = 0;
  s.key = 0;
  s.doubleclick = 0;
  s.control = event.control;
  s.shift = event.shift;
  s.alt = event.alt;
  if (mouse) {
    s.dx = event.x - s.x;
    s.dy = event.y - s.y;
    s.x = event.x;
    s.y = event.y;
    s.mouserect =
        mjr_findRect(static_cast<int>(s.x), static_cast<int>(s.y), s.nrect - 1, s.rect + 1) + 1;
  }
  const bool down = event.type == InputEvent::kPress;
  if (down || event.type == InputEvent::kRelease) {
    if (event.button == mjBUTTON_LEFT) s.left = down;
    if (event.button == mjBUTTON_RIGHT) s.right = down;
    if (event.button == mjBUTTON_MIDDLE) s.middle = down;
  }
  switch (event.type) {
    case InputEvent::kMove:
      s.type = mjEVENT_MOVE;
      break;
    case InputEvent::kPress:
      s.type = mjEVENT_PRESS;
      s.doubleclick =
          event.button == s.button && now - s.buttontime < kDoubleClick + 2 * picture_seconds;
      s.button = event.button;
      s.buttontime = now;
      if (s.mouserect) {
        s.dragbutton = s.button;
        s.dragrect = s.mouserect;
      }
      break;
    case InputEvent::kRelease:
      s.type = mjEVENT_RELEASE;
      break;
    case InputEvent::kScroll:
      s.type = mjEVENT_SCROLL;
      s.sx = event.x;
      s.sy = event.y;
      break;
    case InputEvent::kKey:
      s.type = mjEVENT_KEY;
      s.key = event.key;
      s.keytime = now;
      break;
    case InputEvent::kResize:
    case InputEvent::kClose:
      s.type = mjEVENT_NONE;
      break;
  }
}

Panels::Change Panels::Handle(const InputEvent& event, double now, const mjrContext* context) {
  Track(event, now);
  mjuiState& s = state_;
  Change change;
  for (mjUI* ui : {left_.get(), right_.get()}) {
    const bool shown = ui == left_.get() ? left_shown : right_shown;
    const bool dragged = s.dragrect == ui->rectid;
    const bool under = s.dragrect == 0 && s.mouserect == ui->rectid;
    const bool typed = s.type == mjEVENT_KEY && ui->editsect > 0;
    if (!shown || s.type == mjEVENT_NONE) continue;
    if (s.type == mjEVENT_KEY ? !typed : !(dragged || under)) continue;
    change.used = true;
    if (const mjuiItem* item = mjui_event(ui, &s, context)) {
      const Entry& entry = entries_[static_cast<size_t>(item->userid)];
      change.item = entry.item;
      change.row = entry.row;
    }
    break;
  }
  if (s.type == mjEVENT_RELEASE) {
    s.dragrect = 0;
    s.dragbutton = 0;
  }
  return change;
}

mjuiItem* Panels::Find(std::string_view section, std::string_view item, mjUI** found) {
  for (mjUI* ui : {left_.get(), right_.get()}) {
    for (int i = 0; i < ui->nsect; ++i) {
      if (section != ui->sect[i].name) continue;
      for (int j = 0; j < ui->sect[i].nitem; ++j) {
        mjuiItem& one = ui->sect[i].item[j];
        if (Short(item) != one.name) continue;
        if (found) *found = ui;
        return &one;
      }
    }
  }
  return nullptr;
}

void Panels::SetText(std::string_view section, std::string_view item, const std::string& text,
                     const mjrContext* context) {
  mjUI* ui = nullptr;
  mjuiItem* found = Find(section, item, &ui);
  if (!found || Short(text) == found->multi.name[0]) return;
  Copy(Short(text), found->multi.name[0]);
  found->multi.nelem = 1;
  mjui_update(found->sectionid, found->itemid, ui, &state_, context);
}

void Panels::Draw(const mjrContext* context) {
  SetText("RTF", "Measured", values_.measured, context);
  SetText("Perturb", "Body", values_.selected, context);
  SetText("Recorder", "State", values_.video_state, context);
  for (mjUI* ui : {left_.get(), right_.get()}) {
    const bool shown = ui == left_.get() ? left_shown : right_shown;
    if (!shown) continue;
    for (int i = 0; i < ui->nsect; ++i) {
      const std::string_view name = ui->sect[i].name;
      const bool moves = name == "Joints" || name == "Controls" || name == "Run" || name == "View";
      if (moves && ui->sect[i].state == mjSECT_OPEN) mjui_update(i, -1, ui, &state_, context);
    }
    mjui_render(ui, &state_, context);
  }
}

void Panels::ShowOnly(std::string_view left, std::string_view right, const mjrContext* context) {
  for (auto& [ui, name] : {std::pair{left_.get(), left}, std::pair{right_.get(), right}}) {
    bool found = name.empty();
    std::vector<std::string> names;
    for (int i = 0; i < ui->nsect; ++i) {
      names.emplace_back(ui->sect[i].name);
      found = found || name == names.back();
      ui->sect[i].state = name == names.back() ? mjSECT_OPEN : mjSECT_CLOSED;
    }
    if (!found) throw NotFoundError(NoSuchName("viewer", "panel", name, names));
    ui->scroll = 0;
    Modify(*ui, context);
  }
}

std::pair<double, double> Panels::PlaceOf(std::string_view section, std::string_view item,
                                          const mjrContext* context) {
  mjUI* ui = nullptr;
  const mjuiItem* found = Find(section, item, &ui);
  if (!found) {
    std::vector<std::string> names;
    for (const mjUI* one : {left_.get(), right_.get()}) {
      for (int i = 0; i < one->nsect; ++i) {
        for (int j = 0; j < one->sect[i].nitem; ++j)
          names.push_back(std::string(one->sect[i].name) + "/" + one->sect[i].item[j].name);
      }
    }
    throw NotFoundError(
        NoSuchName("viewer", "item", std::string(section) + "/" + std::string(item), names));
  }
  ui->sect[found->sectionid].state = mjSECT_OPEN;
  Modify(*ui, context);
  const mjrRect& window = state_.rect[ui->rectid];
  const mjrRect& rect = found->rect;
  const double x = window.left + rect.left + 0.5 * rect.width;
  const double y =
      window.bottom + window.height - (ui->height - rect.bottom - 0.5 * rect.height) + ui->scroll;
  return {x, y};
}

}  // namespace robocell::internal
