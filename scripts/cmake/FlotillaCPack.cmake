# SPDX-License-Identifier: MIT
# Binary packages: cpack -G DEB or -G TGZ in a build folder. One package holds library, headers, command and licences.
set(CPACK_PACKAGE_NAME flotilla)
set(CPACK_PACKAGE_VENDOR "The flotilla authors")
set(CPACK_PACKAGE_CONTACT "The flotilla authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
string(CONCAT CPACK_PACKAGE_DESCRIPTION
  "Library and command that simulate rigid bodies given as triangle meshes, surfaces without thickness among them. At "
  "the end of every time step no two bodies intersect, none has passed through another on the way, and this is proved.")
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_GENERATOR TGZ DEB)
set(CPACK_MONOLITHIC_INSTALL ON) # the component python is a wheel of its own
set(CPACK_STRIP_FILES ON)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${CPACK_PACKAGE_CONTACT}")
# What the command needs is read from it; what a program needs to link the static library is only suggested.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "cmake, g++, libhdf5-dev, libpng-dev, libtbb-dev, zlib1g-dev")
include(CPack)
