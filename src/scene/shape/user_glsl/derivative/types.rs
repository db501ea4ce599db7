//! The types of GLSL, with the properties that a derivative depends on.

/// The type of a scalar or a component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    Void,
    Bool,
    Int,
    Uint,
    Float,
    /// The structure with this index.
    Struct(usize),
}

/// A type of GLSL.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Type {
    pub base: Base,
    /// Number of columns of a matrix; 1 for any other type.
    pub columns: usize,
    /// Number of components of a vector or of a matrix column; 1 for a scalar.
    pub rows: usize,
    /// The length of an array, as text; empty if the initial value determines the length.
    pub length: Option<String>,
}

impl Type {
    pub fn new(base: Base, columns: usize, rows: usize) -> Type {
        Type {
            base,
            columns,
            rows,
            length: None,
        }
    }

    pub fn scalar(base: Base) -> Type {
        Type::new(base, 1, 1)
    }

    pub fn vector(base: Base, rows: usize) -> Type {
        Type::new(base, 1, rows)
    }

    /// The type with this name in GLSL.
    pub fn named(word: &str) -> Option<Type> {
        let scalar = match word {
            "void" => Base::Void,
            "bool" => Base::Bool,
            "int" => Base::Int,
            "uint" => Base::Uint,
            "float" => Base::Float,
            _ => return Type::composed(word),
        };
        Some(Type::scalar(scalar))
    }

    fn composed(word: &str) -> Option<Type> {
        let size = |text: &str| match text {
            "2" => Some(2),
            "3" => Some(3),
            "4" => Some(4),
            _ => None,
        };
        if let Some(sizes) = word.strip_prefix("mat") {
            let (columns, rows) = sizes.split_once('x').unwrap_or((sizes, sizes));
            return Some(Type::new(Base::Float, size(columns)?, size(rows)?));
        }
        let (prefix, rows) = word.split_once("vec")?;
        let base = match prefix {
            "" => Base::Float,
            "b" => Base::Bool,
            "i" => Base::Int,
            "u" => Base::Uint,
            _ => return None,
        };
        Some(Type::vector(base, size(rows)?))
    }

    /// The name of the type; for a structure, the caller must find the name.
    pub fn name(&self) -> String {
        let (scalar, prefix) = match self.base {
            Base::Void | Base::Struct(_) => ("void", ""),
            Base::Bool => ("bool", "b"),
            Base::Int => ("int", "i"),
            Base::Uint => ("uint", "u"),
            Base::Float => ("float", ""),
        };
        match (self.columns, self.rows) {
            (1, 1) => scalar.to_owned(),
            (1, rows) => format!("{prefix}vec{rows}"),
            (columns, rows) if columns == rows => format!("mat{columns}"),
            (columns, rows) => format!("mat{columns}x{rows}"),
        }
    }

    pub fn is_array(&self) -> bool {
        self.length.is_some()
    }

    pub fn is_matrix(&self) -> bool {
        self.columns > 1
    }

    pub fn is_vector(&self) -> bool {
        self.columns == 1 && self.rows > 1
    }

    /// Whether the type is a single number or boolean.
    pub fn is_scalar(&self) -> bool {
        self.columns == 1 && self.rows == 1 && !self.is_array() && !self.is_struct()
    }

    pub fn is_struct(&self) -> bool {
        matches!(self.base, Base::Struct(_))
    }

    /// Whether the type is a scalar, vector or matrix of floats.
    pub fn is_float(&self) -> bool {
        self.base == Base::Float && !self.is_array()
    }

    /// The type of an element of an array, of a column of a matrix, or of a component of a vector.
    pub fn element(&self) -> Option<Type> {
        let mut element = self.clone();
        if self.is_array() {
            element.length = None;
        } else if self.is_matrix() {
            element.columns = 1;
        } else if self.is_vector() {
            element.rows = 1;
        } else {
            return None;
        }
        Some(element)
    }

    /// The same type with another base.
    pub fn of(&self, base: Base) -> Type {
        Type {
            base,
            ..self.clone()
        }
    }

    /// Whether both types are equal, ignoring the lengths of arrays, which the compiler checks.
    pub fn is_same(&self, other: &Type) -> bool {
        self.base == other.base
            && (self.columns, self.rows) == (other.columns, other.rows)
            && self.is_array() == other.is_array()
    }

    /// Whether a value of the other type is accepted for this type: integers are converted to floats implicitly.
    pub fn takes(&self, other: &Type) -> bool {
        let is_whole = matches!(other.base, Base::Int | Base::Uint);
        self.is_same(other)
            || self.base == Base::Float && is_whole && self.is_same(&other.of(Base::Float))
    }
}
