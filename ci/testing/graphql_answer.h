// Answers GraphQL queries from a JSON model, for stand-in servers: fields, arguments, variables, and the connections
// and filters of CDash 5.3.0 (graphql/schema.graphql; Lighthouse's @hasMany(type: CONNECTION) with first, after, edges,
// node and pageInfo; app/GraphQL/Directives/FilterDirective.php: eq, all, any). It knows nothing of who asks.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

namespace touchstone::testing {

struct GraphqlField {
  std::string name;
  nlohmann::json arguments = nlohmann::json::object();
  std::vector<GraphqlField> fields;
};

// The top-level fields; `mutation` says which operation it is. Throws std::invalid_argument on a syntax error.
struct GraphqlRequest {
  bool mutation = false;
  std::vector<GraphqlField> fields;
};
GraphqlRequest parse_graphql(const std::string& query, const nlohmann::json& variables);

// The value of the wanted fields of an object of the model. In the model {"connection": [...]} is a connection, an
// array a plain list. Throws std::invalid_argument for a field that the object does not have.
nlohmann::json graphql_value(const nlohmann::json& model, const GraphqlField& field);

}  // namespace touchstone::testing
