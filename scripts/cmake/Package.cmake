# Debian packages, made by `cpack -G DEB` (scripts/package): touchtrace and libtouchtrace-dev.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "touchtrace developers <touchtrace@users.noreply.github.com>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL program development)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS OFF)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME touchtrace)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "pocl-opencl-icd | opencl-icd")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "Calibrates an RGB-D camera, labels its video with positions, velocities and
covariances of a hand and an object, trains a model of their motion from
touch on any OpenCL device, and evaluates it. Contains a scene simulator.")

# The libraries are static: a program that links them needs the development files of their dependencies.
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libtouchtrace-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
file(STRINGS scripts/packages development_packages REGEX "^[a-z0-9.+-]+-dev$|^pkg-config$|^opencl-headers$|^opencl-clhpp-headers$")
list(FILTER development_packages EXCLUDE REGEX "libgtest")
list(JOIN development_packages ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Static libraries, headers and CMake files of touchtrace: OpenCL training
engine, camera calibration and smoothing, recordings, labels, simulator.")

# Debian asks for a copyright file and a changelog in each package.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
configure_file(scripts/cmake/changelog.in ${PROJECT_BINARY_DIR}/generated/changelog)
configure_file(scripts/cmake/copyright.in ${PROJECT_BINARY_DIR}/generated/copyright COPYONLY)
execute_process(COMMAND gzip -9n -f -k ${PROJECT_BINARY_DIR}/generated/changelog)
foreach(package touchtrace:program libtouchtrace-dev:development)
  string(REPLACE ":" ";" package ${package})
  list(GET package 0 name)
  list(GET package 1 component)
  install(FILES ${PROJECT_BINARY_DIR}/generated/copyright ${PROJECT_BINARY_DIR}/generated/changelog.gz
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
endforeach()

include(CPack)
