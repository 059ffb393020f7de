#pragma once

// Templates of Eigen and nlohmann's JSON that many units use, declared so that only compiled_once.cc generates their
// code: about a fifth of what compiling the program cost was generating the same code again.
// The precompiled headers of rooms and tests include this; no source needs it, and what a
// unit computes stays as it is. A target with one of these precompiled headers links touchstone::base.

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <nlohmann/json.hpp>

#ifndef TOUCHSTONE_COMPILED_ONCE
#define TOUCHSTONE_COMPILED_ONCE extern
#endif

TOUCHSTONE_COMPILED_ONCE template union nlohmann::basic_json<>::json_value;
TOUCHSTONE_COMPILED_ONCE template nlohmann::basic_json<>::basic_json(const nlohmann::json&);
TOUCHSTONE_COMPILED_ONCE template nlohmann::basic_json<>::basic_json(nlohmann::json::initializer_list_t, bool,
                                                                     nlohmann::json::value_t);
TOUCHSTONE_COMPILED_ONCE template nlohmann::json::string_t nlohmann::basic_json<>::dump(
    int, char, bool, nlohmann::json::error_handler_t) const;
TOUCHSTONE_COMPILED_ONCE template class nlohmann::detail::serializer<nlohmann::json>;
TOUCHSTONE_COMPILED_ONCE template class nlohmann::detail::lexer<
    nlohmann::json, nlohmann::detail::iterator_input_adapter<std::string::const_iterator>>;
TOUCHSTONE_COMPILED_ONCE template class nlohmann::detail::parser<
    nlohmann::json, nlohmann::detail::iterator_input_adapter<std::string::const_iterator>>;
TOUCHSTONE_COMPILED_ONCE template class nlohmann::detail::serializer<nlohmann::ordered_json>;
TOUCHSTONE_COMPILED_ONCE template union nlohmann::basic_json<nlohmann::ordered_map>::json_value;
TOUCHSTONE_COMPILED_ONCE template nlohmann::basic_json<nlohmann::ordered_map>::basic_json(
    const nlohmann::ordered_json&);
TOUCHSTONE_COMPILED_ONCE template nlohmann::basic_json<nlohmann::ordered_map>::basic_json(
    nlohmann::ordered_json::initializer_list_t, bool, nlohmann::ordered_json::value_t);

TOUCHSTONE_COMPILED_ONCE template class Eigen::LDLT<Eigen::MatrixXd>;
TOUCHSTONE_COMPILED_ONCE template Eigen::LDLT<Eigen::MatrixXd>::LDLT(const Eigen::EigenBase<Eigen::MatrixXd>&);
TOUCHSTONE_COMPILED_ONCE template Eigen::LDLT<Eigen::MatrixXd>& Eigen::LDLT<Eigen::MatrixXd>::compute<Eigen::MatrixXd>(
    const Eigen::EigenBase<Eigen::MatrixXd>&);
TOUCHSTONE_COMPILED_ONCE template class Eigen::LLT<Eigen::MatrixXd>;
TOUCHSTONE_COMPILED_ONCE template Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>&
Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>::compute<Eigen::MatrixXd>(const Eigen::EigenBase<Eigen::MatrixXd>&, int);
TOUCHSTONE_COMPILED_ONCE template struct Eigen::internal::gebp_kernel<
    double, double, Eigen::Index, Eigen::internal::blas_data_mapper<double, Eigen::Index, 0, 0, 1>, 4, 4, false, false>;
