# `cpack`: one Debian package a component, of a build that is configured for /usr, as by the preset
# `package`; scripts/packages.sh makes them, installs them on a clean root and uses them there.
set(MINDAHL_PACKAGE_MAINTAINER "The mindahl developers <mindahl@localhost>" CACHE STRING
    "Maintainer of the Debian packages: name and address")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR "The mindahl developers")
set(CPACK_PACKAGE_CONTACT "${MINDAHL_PACKAGE_MAINTAINER}")
set(CPACK_PACKAGE_NAME mindahl)
# Of each package its own; a common one would come before it.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${PROJECT_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# A component that nothing is installed to has no package: `python` is there where it is built.
get_cmake_property(installed COMPONENTS)
set(CPACK_COMPONENTS_ALL tool development)
if(python IN_LIST installed)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()

set(CPACK_DEBIAN_TOOL_PACKAGE_NAME mindahl)
set(CPACK_DEBIAN_TOOL_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TOOL_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_TOOL_PACKAGE_RECOMMENDS "librsvg2-bin")
set(CPACK_DEBIAN_TOOL_DESCRIPTION
    "friction parameters of a contact from its hysteresis loop
From the measured tangential displacement and force of a contact to its
tangential stiffness, shape exponent and slip force, with uncertainties and
verdicts, and to the Hertz-Mindlin contact behind them. Also simulates,
converts and plans such tests.")

list(JOIN linked_packages ", " linked_packages)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libmindahl-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${linked_packages}")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION
    "identification of friction parameters - C++ library
Headers and static libraries of mindahl, its CMake package and pkg-config
file, and the schemas of what the program writes as JSON.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-mindahl)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-matplotlib, python3-pandas")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION
    "identification of friction parameters - Python module
Fits measured hysteresis loops of a contact from NumPy arrays: import mindahl.")
if(python IN_LIST installed)
  # An extension is of one minor version of Python.
  execute_process(
    COMMAND ${MINDAHL_PYTHON} -c
            "import sys; a, b = sys.version_info[:2]; print(f'python3 (>= {a}.{b}), python3 (<< {a}.{b + 1}), python3-numpy')"
    OUTPUT_VARIABLE CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS OUTPUT_STRIP_TRAILING_WHITESPACE
    COMMAND_ERROR_IS_FATAL ANY)
endif()
include(CPack)
