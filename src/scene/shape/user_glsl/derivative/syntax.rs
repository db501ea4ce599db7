//! The syntax tree of a field's text.

use super::types::Type;

/// An expression.
#[derive(Debug)]
pub struct Expression<'a> {
    pub kind: ExpressionKind<'a>,
    /// Depth of the tree, including this node.
    pub depth: usize,
}

#[derive(Debug)]
pub enum ExpressionKind<'a> {
    /// A literal number, or `true` or `false`.
    Literal(&'a str),
    Name(&'a str),
    /// A prefix operator.
    Prefix(&'a str, Box<Expression<'a>>),
    /// `x++` or `x--`.
    Postfix(&'a str, Box<Expression<'a>>),
    Binary(&'a str, Box<Expression<'a>>, Box<Expression<'a>>),
    /// An assignment, with its operator.
    Assignment(&'a str, Box<Expression<'a>>, Box<Expression<'a>>),
    /// The operator `? :`: the condition, and the values if it is true and if it is false.
    Choice([Box<Expression<'a>>; 3]),
    Index(Box<Expression<'a>>, Box<Expression<'a>>),
    /// A member of a structure, or a selection of components.
    Member(Box<Expression<'a>>, &'a str),
    Call(&'a str, Vec<Expression<'a>>),
    Constructor(Type, Vec<Expression<'a>>),
    /// The number of elements, `array.length()`.
    Length(Box<Expression<'a>>),
}

/// A declared variable.
#[derive(Debug)]
pub struct Variable<'a> {
    pub name: &'a str,
    pub of_type: Type,
    pub initial: Option<Expression<'a>>,
}

#[derive(Debug)]
pub struct Declaration<'a> {
    pub is_const: bool,
    pub variables: Vec<Variable<'a>>,
}

#[derive(Debug)]
pub enum Statement<'a> {
    Block(Vec<Statement<'a>>),
    Declaration(Declaration<'a>),
    Expression(Expression<'a>),
    If(Expression<'a>, Vec<Statement<'a>>, Vec<Statement<'a>>),
    For {
        first: Vec<Statement<'a>>,
        condition: Option<Expression<'a>>,
        step: Option<Expression<'a>>,
        body: Vec<Statement<'a>>,
    },
    While(Expression<'a>, Vec<Statement<'a>>),
    DoWhile(Vec<Statement<'a>>, Expression<'a>),
    Switch(Expression<'a>, Vec<Statement<'a>>),
    /// `case value:`, or `default:`.
    Case(Option<Expression<'a>>),
    Return(Option<Expression<'a>>),
    /// `break` or `continue`.
    Jump(&'a str),
}

#[derive(Debug)]
pub struct Parameter<'a> {
    pub name: &'a str,
    pub of_type: Type,
    /// Whether the argument is copied to the parameter before the call.
    pub is_in: bool,
    /// Whether the parameter is copied to the argument after the call.
    pub is_out: bool,
}

#[derive(Debug)]
pub struct Function<'a> {
    pub name: &'a str,
    pub returns: Type,
    pub parameters: Vec<Parameter<'a>>,
    /// The statements, or the reason why they cannot be parsed. Other functions of the text can still be
    /// differentiated.
    pub body: Result<Vec<Statement<'a>>, super::Obstacle>,
}

#[derive(Debug)]
pub struct Structure<'a> {
    /// Empty for an anonymous structure.
    pub name: &'a str,
    pub members: Vec<(&'a str, Type)>,
}

/// A whole preprocessed text.
#[derive(Debug, Default)]
pub struct Program<'a> {
    pub structures: Vec<Structure<'a>>,
    pub globals: Vec<Declaration<'a>>,
    pub functions: Vec<Function<'a>>,
}
