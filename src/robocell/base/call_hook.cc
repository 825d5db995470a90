#include "robocell/base/call_hook.h"

#include <stdexcept>
#include <string>

namespace robocell::internal {

void RethrowOfHook(const Hooks& hooks, const char* method) {
  try {
    throw;
  } catch (const HookError& error) {
    const std::string place = error.has_place() ? "" : hooks.PlaceOfHook(method);
    if (place.empty()) throw;
    throw HookError(error.what(), place, error.kind());
  } catch (const IoError&) {
    throw;
  } catch (const SpecError&) {
    throw;
  } catch (const EngineError&) {
    throw;
  } catch (const ClosedError&) {
    throw;
  } catch (const DivergedError&) {
    throw;
  } catch (const ArgumentError& error) {
    throw HookError(error.what(), hooks.PlaceOfHook(method));
  } catch (const NotFoundError& error) {
    throw HookError(error.what(), hooks.PlaceOfHook(method));
  } catch (const std::runtime_error& error) {
    throw HookError("in " + std::string(method) + ": " + error.what(), hooks.PlaceOfHook(method),
                    HookError::Kind::kFailed);
  } catch (const std::logic_error& error) {
    throw HookError("in " + std::string(method) + ": " + error.what(), hooks.PlaceOfHook(method),
                    HookError::Kind::kFailed);
  }
}

}  // namespace robocell::internal
