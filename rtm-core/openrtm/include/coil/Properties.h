// A tree of named strings: `a.b.c` is the node c below b below a. Children keep the order in which they were made.
// One thread at a time; const functions may run in parallel. Knows nothing of CORBA.
#pragma once

#include <climits>
#include <iosfwd>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace coil {

class Properties {
 public:
  // A node without a parent.
  Properties(const char* key = "", const char* value = "");
  Properties(const std::string& key, const std::string& value = "");
  // Default values from pairs of key (a path) and value.
  Properties(const std::map<std::string, std::string>& defaults);
  // Default values from key, value, key, value, ... up to an empty or null key or `count` strings.
  Properties(const char* const* defaults, long count = LONG_MAX);

  Properties(const Properties& other);
  Properties(Properties&& other) noexcept;
  // Replaces value, default and children; a node inside a tree keeps its name and place.
  Properties& operator=(const Properties& other);
  Properties& operator=(Properties&& other) noexcept;
  virtual ~Properties();

  const char* getName() const { return name_.c_str(); }
  const char* getValue() const { return value_.c_str(); }
  const char* getDefaultValue() const { return default_value_.c_str(); }
  // The children; they belong to this node.
  const std::vector<Properties*>& getLeaf() const { return leaf_; }
  const Properties* getRoot() const { return root_; }

  // The value at the path, else its default, else an empty string.
  const std::string& getProperty(const std::string& key) const;
  // The value at the path, or `def` when that is empty or missing; the stored default plays no part.
  std::string getProperty(const std::string& key, const std::string& def) const;
  const std::string& operator[](const std::string& key) const { return getProperty(key); }
  // Makes the node if it is missing; a value that was only a default becomes a value.
  std::string& operator[](const std::string& key);
  const std::string& getDefault(const std::string& key) const;

  // Makes the node if it is missing. Returns the value (the default) it had before.
  std::string setProperty(const std::string& key, const std::string& value);
  std::string setDefault(const std::string& key, const std::string& value);
  void setDefaults(const char* const* defaults, long count = LONG_MAX);

  // Reads lines `key: value`, `key = value` or `key value`. Lines starting with # or ! are comments, a backslash at the end of a line
  // continues it, \n \t \r \f \" \\ and backslash before any other character are escapes.
  void load(std::istream& in);
  void store(std::ostream& out, const std::string& header) const;
  void save(std::ostream& out, const std::string& header) const { store(out, header); }
  // The tree, indented.
  void list(std::ostream& out) const;

  // The path of every node that has a value or no children.
  std::vector<std::string> propertyNames() const;
  int size() const;

  // The node at the path, nullptr if there is none (or the path is empty).
  Properties* findNode(const std::string& key) const;
  // Makes the node if it is missing. An empty path is this node.
  Properties& getNode(const std::string& key);
  // False if the node exists already or the path is empty.
  bool createNode(const std::string& key);
  // Takes a direct child out of the tree and hands it to the caller, who deletes it; nullptr if there is none.
  Properties* removeNode(const std::string& leaf_name);
  // The direct child of that name or nullptr.
  Properties* hasKey(const std::string& key) const;
  // Deletes all children.
  void clear();

  // Takes over every value of the other tree; what only this one has stays.
  Properties& operator<<(const Properties& other);

  friend std::ostream& operator<<(std::ostream& out, const Properties& properties);

 private:
  Properties* child(std::string_view name) const;
  const Properties* find(std::string_view path) const;
  Properties& make(std::string_view path);
  void add_child(Properties* node);
  struct WithoutChildren {};
  Properties(const Properties& other, WithoutChildren);
  void copy_descendants(const Properties& other);
  void adopt_children(Properties& other) noexcept;
  template <class Visit>
  void walk(Visit visit) const;

  std::string name_;
  std::string value_;
  std::string default_value_;
  Properties* root_ = nullptr;
  std::vector<Properties*> leaf_;  // Owned. Plain pointers because getLeaf() has always shown them so.
  // The children by name, once there are many.
  using Index = std::unordered_map<std::string_view, Properties*>;
  std::unique_ptr<Index> index_;
};

}  // namespace coil
