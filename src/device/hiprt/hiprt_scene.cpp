#include "device/hiprt/hiprt_scene.h"

#include <utility>

namespace kadr {

bool HiprtScene::set_frame(const SceneSnapshot& snapshot) {
    if (is_staged(snapshot)) {
        std::swap(current_, next_);
        staged_.reset();
        return true;
    }
    current_->set(snapshot);
    return false;
}

void HiprtScene::stage(std::shared_ptr<const SceneSnapshot> next) {
    staged_.reset();
    if (!next_) next_ = std::make_unique<HiprtFrame>(shared_);
    next_->set(*next);
    staged_ = std::move(next);
}

bool HiprtScene::drop_staged() {
    staged_.reset();
    return std::exchange(next_, nullptr) != nullptr;
}

bool HiprtScene::lower_quality() {
    staged_.reset();
    current_->forget();
    if (next_) next_->forget();
    return shared_.rigid.lower_quality();
}

}  // namespace kadr
