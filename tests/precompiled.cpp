// Nothing but the precompiled header (CMakeLists.txt).
