#include "device/embree/instance_level.h"

namespace kadr {
namespace {

/// Embree's quaternion form of a key: translation * rotation * (scale with shear above the diagonal).
RTCQuaternionDecomposition to_embree(const kernels::TransformKey& key) {
    RTCQuaternionDecomposition q;
    rtcInitQuaternionDecomposition(&q);
    rtcQuaternionDecompositionSetQuaternion(&q, key.rotation[3], key.rotation[0], key.rotation[1], key.rotation[2]);
    rtcQuaternionDecompositionSetScale(&q, key.scale[0], key.scale[1], key.scale[2]);
    rtcQuaternionDecompositionSetSkew(&q, key.shear[0], key.shear[1], key.shear[2]);
    rtcQuaternionDecompositionSetTranslation(&q, key.translation[0], key.translation[1], key.translation[2]);
    return q;
}

}  // namespace

void InstanceLevel::resize(std::size_t count) {
    for (std::size_t i = count; i < slots_.size(); ++i)
        if (slots_[i].attached) rtcDetachGeometry(level_.get(), static_cast<unsigned>(i));
    slots_.resize(count);
}

void InstanceLevel::hide(std::size_t index) { slots_[index].shown = false; }

void InstanceLevel::show(std::size_t index, RTCScene mesh, std::span<const kernels::Affine> frames) {
    RTCGeometry geometry = prepare(index, mesh, frames.size(), false);
    for (std::size_t k = 0; k < frames.size(); ++k)
        rtcSetGeometryTransform(geometry, static_cast<unsigned>(k), RTC_FORMAT_FLOAT3X4_ROW_MAJOR, frames[k].m);
    rtcCommitGeometry(geometry);
}

void InstanceLevel::show(std::size_t index, RTCScene mesh, std::span<const kernels::TransformKey> frames) {
    RTCGeometry geometry = prepare(index, mesh, frames.size(), true);
    for (std::size_t k = 0; k < frames.size(); ++k) {
        const RTCQuaternionDecomposition q = to_embree(frames[k]);
        rtcSetGeometryTransformQuaternion(geometry, static_cast<unsigned>(k), &q);
    }
    rtcCommitGeometry(geometry);
}

RTCGeometry InstanceLevel::prepare(std::size_t index, RTCScene mesh, std::size_t frame_count, bool slerps) {
    Slot& slot = slots_[index];
    // Embree keeps apart how many frames there are and how they are interpolated; a new kind starts anew.
    if (slot.geometry && (slot.frame_count != frame_count || slot.slerps != slerps)) slot.geometry.reset();
    if (!slot.geometry) {
        slot.geometry.reset(rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE));
        slot.frame_count = static_cast<unsigned>(frame_count);
        slot.slerps = slerps;
        rtcSetGeometryTimeStepCount(slot.geometry.get(), slot.frame_count);
        slot.fresh = true;
    }
    slot.shown = true;
    rtcSetGeometryInstancedScene(slot.geometry.get(), mesh);
    return slot.geometry.get();
}

void InstanceLevel::commit() {
    for (std::size_t i = 0; i < slots_.size(); ++i) {
        Slot& slot = slots_[i];
        const auto id = static_cast<unsigned>(i);
        if (slot.attached && (slot.fresh || !slot.shown)) {
            rtcDetachGeometry(level_.get(), id);
            slot.attached = false;
        }
        if (slot.shown && !slot.attached) {
            rtcAttachGeometryByID(level_.get(), slot.geometry.get(), id);
            slot.attached = true;
        }
        if (!slot.shown) slot.geometry.reset();
        slot.fresh = false;
    }
    rtcCommitScene(level_.get());
}

}  // namespace kadr
